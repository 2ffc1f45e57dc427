// afm_pll.v - a PLL for an AFM, one clock a sample: NCO, mixer, low-pass of one pole, PI controller. 16 bits in and out.
//
// The reading belongs to the instant at which the next sample begins. So the cosine that goes out next is also the
// reference of the mixer. For a reading A cos(theta + phi) the mixer's mean is A cos(phi)/2, which is 0 at the
// resonance, phi = -90 degrees.
module afm_pll(input clk, input locks, input [31:0] start, input signed [15:0] adc, output reg signed [15:0] dac,
               output reg [31:0] step);
    localparam integer DRIVE = 6554;   // codes of the tone: 2 V
    localparam integer POLE = 5;       // of the low-pass: 1/32 a sample, 4.5 kHz
    localparam signed [47:0] KP = 46;  // steps per code of error; a radian is 3277 codes and a Hz 4793.5 steps
    localparam signed [47:0] KI = 29;  // 1/1024 of a step per code and sample: KP/KI is the lever's time
    reg signed [15:0] table_of_cosine[0:1023];
    integer i;
    initial begin
        for (i = 0; i < 1024; i = i + 1)
            table_of_cosine[i] = $rtoi($floor(32767.0 * $cos(6.283185307179586 * i / 1024.0) + 0.5));
        phase = 0;
        mean = 0;
        sum = 0;
        dac = 0;
        step = 0;
    end
    reg [31:0] phase;
    reg signed [47:0] mean, sum;
    wire [31:0] next = phase + step;
    wire signed [15:0] cosine = table_of_cosine[next[31:22]];
    wire signed [47:0] mixed = 48'(adc) * 48'(cosine) - mean;
    wire signed [47:0] error = mean >>> 15;
    wire signed [47:0] moved = (KP * error + (sum >>> 10));
    always @(posedge clk) begin
        phase <= next;
        dac <= 16'((48'(cosine) * DRIVE) >>> 15);
        mean <= mean + (mixed >>> POLE);
        sum <= locks ? sum + KI * error : 0;
        step <= locks ? start + moved[31:0] : start;
    end
endmodule
