/* packet.c - the UDP packet parser: what it takes are classic frames, and packed again they are the same. */
#include "hal/link/cannelloni.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fixture/packet.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct frame frame[CANNELLONI_FRAMES_MAX], again[CANNELLONI_FRAMES_MAX];
    static struct cannelloni p;
    uint32_t others = 0, none = 0;
    int n = cannelloni_parse(data, size, frame, CANNELLONI_FRAMES_MAX, &others), packed = 0;
    MUST(n >= -1 && n <= CANNELLONI_FRAMES_MAX);
    MUST(n < 0 ? others == 0 : n + (int)others == (data[3] << 8 | data[4]));
    MUST(cannelloni_parse(data, size, again, 3, &others) <= 3);
    cannelloni_begin(&p, 0);
    for (int i = 0; i < n; i++) {
        uint32_t last = frame[i].flags & FRAME_EXTENDED ? 0x1FFFFFFFu : 0x7FFu;
        MUST(frame[i].length <= FRAME_DATA && frame[i].id <= last && !(frame[i].flags & ~FRAME_EXTENDED));
        if (packed == i && cannelloni_has_room(&p, &frame[i])) {
            cannelloni_add(&p, &frame[i]);
            packed++;
        }
    }
    MUST(cannelloni_parse(p.bytes, p.n_bytes, again, CANNELLONI_FRAMES_MAX, &none) == packed && none == 0);
    for (int i = 0; i < packed; i++)
        MUST(packet_same(&frame[i], &again[i]));
    return 0;
}
