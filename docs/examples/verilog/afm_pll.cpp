// afm_pll.cpp - the PLL of afm_pll.v on the microscope of contactplant.h: offset and lock time beside closed
// forms.
#include <cmath>
#include <cstdio>
#include <ctime>
#include "Vafm_pll.h"
#include "contactplant.h"
#include "verilated.h"

static union contactplant_afm_memory memory;
static int failed;

static void check(const char *what, double got, double wanted, double allowed)
{
    bool good = std::fabs(got - wanted) <= allowed;
    std::printf("%s  %s: %.6g, expected %.6g, off by %.2g (allowed %.2g)\n", good ? "ok  " : "FAIL", what,
                got, wanted, got - wanted, allowed);
    failed += !good;
}

// A cold lever far from the sample, 64 ticks a period.
static const char scene[] = "[plant]\nmodel = afm_lever\nmethod = modal\nheight = 500 nm\n"
                            "[deadline]\nframe = 1 ms\nsubsteps = 64\ndilation = 70\n";
static const double f0 = 70e3, quality = 400.0, pi = 3.141592653589793;

int main(int argc, char **argv)
{
    Verilated::commandArgs(argc, argv);
    struct contactplant_error error;
    contactplant_afm *afm = contactplant_afm_open(&memory, sizeof memory, scene, &error);
    if (!afm)
        return std::printf("FAIL  %s\n", error.text), 1;
    contactplant_afm_set(afm, contactplant_afm_find(afm, "ticks"), 5.0);
    contactplant_afm_set(afm, contactplant_afm_find(afm, "deflection_m_per_V"), 10e-9);
    const double sample = contactplant_afm_sample_time(afm), hz = 4294967296.0 * sample;
    // A code is held for 5 ticks, with kicks at both ends of each: it comes 2.5 ticks of 64 late.
    const double lag = 2.0 * pi * 2.5 / 64.0, offset = -f0 * std::tan(lag) / (2.0 * quality), begins = 20.0;
    Vafm_pll pll;
    int32_t dac[CONTACTPLANT_AFM_DACS] = {0}, adc[CONTACTPLANT_AFM_ADCS] = {0};
    double sum = 0.0, locked = 0.0, mean = 0.0, worst = 0.0;
    // The frequency is judged by means over 64 samples, 5 periods: so the mixer's ripple is left out.
    const long block = 64, ring = 280 * block, all = 31250 * block;
    timespec from, to;
    pll.start = (uint32_t)((f0 + offset + begins) * hz);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &from);
    for (long i = 0; i < all; i++) {
        pll.locks = i >= ring;
        pll.adc = (uint16_t)adc[CONTACTPLANT_AFM_DEFLECTION];
        pll.clk = 0;
        pll.eval();
        pll.clk = 1;
        pll.eval();
        dac[CONTACTPLANT_AFM_DITHER] = (int16_t)pll.dac;
        if (contactplant_afm_sample(afm, dac, adc) != CONTACTPLANT_OK)
            return std::printf("FAIL  %s\n", contactplant_afm_error(afm)), 1;
        sum += pll.step / hz - f0;
        if ((i + 1) % block)
            continue;
        double f = sum / block;
        sum = 0.0;
        if (i >= ring && std::fabs(f - offset) > 1.0)
            locked = (double)(i + 1 - ring) * sample;
        if (i >= all / 2)
            mean += f * block / (double)(all - all / 2);
        if (i >= all / 2 && std::fabs(f - offset) > worst)
            worst = std::fabs(f - offset);
    }
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &to);
    double seconds = (double)(to.tv_sec - from.tv_sec) + 1e-9 * (double)(to.tv_nsec - from.tv_nsec);
    // The PI's zero takes away the lever's pole. So the frequency settles with one pole, of rate (slope of
    // the phase) ki, after a jump by the proportional part, kp = ki tau. Off the resonance by the lag the
    // lever's amplitude is cos(lag) times 20 nm, and the slope cos(lag)^2 times 2 Q/f0. A tone held for 5
    // ticks has the share `held`.
    const double c = std::cos(lag), held = std::sin(lag) / (5.0 * std::tan(lag / 5.0));
    const double radian = 0.5 * 2.0 * held * c / (20.0 / 65536.0), ki = 29.0 / 1024.0 * radian / sample / hz;
    const double rate = 2.0 * quality / f0 * c * c * ki;
    check("frequency off the resonance, Hz", mean, offset, 0.01 * std::fabs(offset));
    check("  as published for 2.5 ticks of 64, Hz", mean, -21.918, 0.219);
    const double closed = std::log(begins * (1.0 - rate * quality / (pi * f0))) / rate;
    check("time to within 1 Hz of it, from 20 Hz, s", locked, closed, 0.05 * closed);
    check("largest deviation then, Hz", worst, 0.0, 0.5);
    std::printf("      %ld samples of %.2f us in %.2f s of processor time: %.1f times real time\n", all,
                sample * 1e6, seconds, (double)all * sample / seconds);
    return failed != 0;
}
