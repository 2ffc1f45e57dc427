/* test_afm_files.c - height fields, pictures and spectra of the microscope's commands. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/afm/gsf.h"
#include "host_sim/afm/png.h"
#include "host_sim/afm/spectrum.h"

/* ---- Gwyddion Simple Field ---- */

static float sample[] = {1.5f, -2.0f, 3e-9f, 0.0f, 7.0f, 1e30f};
static const struct gsf field = {3, 2, 2e-6, 1e-6, "m", "Height", sample};

/* The bytes of `g` in a file to be read, with byte `at` (from
 * the end) changed by `by`, or some bytes less or more. */
static FILE *written(const struct gsf *g, char *bytes, size_t *n)
{
    FILE *f = tmpfile();
    gsf_write(f, g);
    rewind(f);
    *n = fread(bytes, 1, 1000, f);
    rewind(f);
    return f;
}

static void refused_file(const char *name, const char *bytes, size_t n, const char *part)
{
    char why[GSF_REASON] = "";
    struct gsf g = {.value = NULL};
    FILE *f = tmpfile();
    fwrite(bytes, 1, n, f);
    rewind(f);
    check_int(name, gsf_read(f, &g, why), 0);
    check_contains("  says", why, part);
    free(g.value);
    fclose(f);
}

TEST(afm_gsf)
{
    char bytes[1000], why[GSF_REASON];
    size_t n;
    FILE *f = written(&field, bytes, &n);
    struct gsf g;
    const char *header = "Gwyddion Simple Field 1.0\nXRes = 3\nYRes = 2\nXReal = 2e-06\nYReal = 1e-06\n"
                         "XYUnits = m\nZUnits = m\nTitle = Height\n";
    size_t length = strlen(header), pad = 4 - length % 4;
    check_bytes("header", bytes, header, length);
    check_int("size: header, 1 to 4 NULs, float32", (long long)n, (long long)(length + pad + sizeof sample));
    check_bytes("NULs", bytes + length, "\0\0\0\0", pad);
    check_bytes("first value, little endian: 1.5", bytes + length + pad, "\0\0\300\077", 4);
    check_int("read", gsf_read(f, &g, why), 1);
    check_bytes("values", g.value, sample, sizeof sample);
    check_near("width", g.width, 2e-6, 1e-15);
    check_int("points", (long long)(g.nx * 10 + g.ny), 32);
    free(g.value);
    fclose(f);
    refused_file("no such file", "hello", 5, "is no file of Gwyddion");
    refused_file("empty", "", 0, "is no file of Gwyddion");
    refused_file("cut off", bytes, n - 1, "wrong size: its header says 3 x 2 values, and it has fewer");
    refused_file("too long", bytes, n + 1, "has more");
    refused_file("no size", "Gwyddion Simple Field 1.0\nXRes = 3\n\0\0\0\0", 40, "no XRes and YRes");
    bytes[length] = 'x';
    refused_file("no NULs", bytes, n, "no NULs");
    bytes[length] = 0;
    memcpy(bytes + n - 4, "\0\0\300\177", 4);
    refused_file("a NaN", bytes, n, "no number, in row 2, column 3");
}

/* Writes a file of 4 x 2 values whose header is this text, and reads it. */
static int read_back(const char *header, struct gsf *g, char *why)
{
    static const unsigned char one[4] = {0, 0, 0x80, 0x3F}; /* 1.0f */
    FILE *f = tmpfile();
    int n = fprintf(f, "Gwyddion Simple Field 1.0\n%s", header);
    for (int i = n % 4; i < 4; i++)
        putc(0, f);
    for (int i = 0; i < 8; i++)
        fwrite(one, 1, 4, f);
    rewind(f);
    *why = 0;
    *g = (struct gsf){.value = NULL};
    int good = gsf_read(f, g, why);
    fclose(f);
    return good;
}

/* The format allows these: https://gwyddion.net/documentation/user-guide-en/gsf.html */
TEST(afm_gsf_headers)
{
    static const char *const same[] = {
        "XRes = 4\nYRes = 2\nXReal = 2e-6\nYReal = 1e-6\n",
        "  XRes=4\n\tYRes   =   2  \nXReal=2e-6\r\nYReal = 1e-6\n",
        "YReal = 1e-6\nTitle = XRes = 9\nXReal = 2e-6\nYRes = 2\nXRes = 4\nXOffset = 5\n",
        "XRes = 4\nYRes = 2\nXReal = 2e3\nYReal = 1000.0\nXYUnits = nm\n"};
    char long_header[9000] = "XRes = 4\nYRes = 2\nXReal = 2e-6\nYReal = 1e-6\nTitle = ";
    char why[GSF_REASON], *end = long_header + strlen(long_header);
    struct gsf g;
    memset(end, 'x', 600);
    end += 600;
    end += sprintf(end, "XRes = 77\n");
    for (int i = 0; i < 300; i++)
        end += sprintf(end, "Own%d = %d\n", i, i);
    for (int i = 0; i < 5; i++) {
        check_int("read", read_back(i < 4 ? same[i] : long_header, &g, why), 1);
        check_string("  says", why, "");
        check_int("points", (long long)(g.nx * 10 + g.ny), 42);
        check_near("width", g.width, 2e-6, 1e-18);
        check_near("length", g.length, 1e-6, 1e-18);
        check_near("a value", g.value ? (double)g.value[7] : 0.0, 1.0, 0.0);
        free(g.value);
    }
    check_int("heights in nm", read_back("XRes = 4\nYRes = 2\nZUnits = nm\n", &g, why), 1);
    check_near("a value", g.value ? (double)g.value[7] : 0.0, 1e-9, 1e-16);
    free(g.value);
    check_int("volts are no heights", read_back("XRes = 4\nYRes = 2\nZUnits = V\n", &g, why), 0);
    check_contains("  says", why, "ZUnits that is no unit of length; write m");
    check_int("a size that is no number", read_back("XRes = 4x\nYRes = 2\n", &g, why), 0);
    check_contains("  says", why, "XRes that is no number");
    check_int("a size with a part", read_back("XRes = 4.5\nYRes = 2\n", &g, why), 0);
    check_contains("  says", why, "no XRes and YRes");
}

/* ---- PNG: what the specification asks for, decoded here ---- */

static unsigned long big(const unsigned char *p)
{
    return (unsigned long)p[0] << 24 | (unsigned long)p[1] << 16 | (unsigned long)p[2] << 8 | p[3];
}

static unsigned long crc(const unsigned char *p, size_t n)
{
    unsigned long c = 0xFFFFFFFFul;
    for (size_t i = 0; i < n; i++) {
        c ^= p[i];
        for (int k = 0; k < 8; k++)
            c = c & 1 ? c >> 1 ^ 0xEDB88320ul : c >> 1;
    }
    return c ^ 0xFFFFFFFFul;
}

TEST(afm_png)
{
    static const unsigned char grey[] = {0, 50, 100, 150, 200, 255};
    unsigned char bytes[300], seen[8];
    FILE *f = tmpfile();
    png_write(f, grey, 3, 2, "black is 1 m");
    rewind(f);
    size_t n = fread(bytes, 1, sizeof bytes, f), at = 8;
    fclose(f);
    check_bytes("signature", bytes, "\211PNG\r\n\032\n", 8);
    check_bytes("kind of the first chunk", bytes + 12, "IHDR", 4);
    check_int("width", (long long)big(bytes + 16), 3);
    check_int("height", (long long)big(bytes + 20), 2);
    check_bytes("8 bits, grey", bytes + 24, "\10\0\0\0\0", 5);
    for (; at + 12 <= n; at += 12 + big(bytes + at))
        check_hex("check of a chunk", big(bytes + at + 8 + big(bytes + at)),
                  crc(bytes + at + 4, 4 + big(bytes + at)));
    check_int("the chunks fill the file", (long long)at, (long long)n);
    check_bytes("text", bytes + 33 + 4, "tEXtDescription\0black is 1 m", 28);
    const unsigned char *data = bytes + 33 + 12 + 24 + 8; /* in IDAT */
    check_int("zlib's header", (data[0] * 256 + data[1]) % 31, 0);
    unsigned long a = 1, b = 0;
    for (int line = 0; line < 2; line++) {
        const unsigned char *block = data + 2 + line * (5 + 4);
        check_int("stored, last", block[0], line);
        check_int("length", block[1] + 256 * block[2], 4);
        check_int("and its complement", block[3] + 256 * block[4], 65535 - 4);
        check_int("no filter", block[5], 0);
        memcpy(seen + 3 * line, block + 6, 3);
        for (int i = 5; i < 9; i++) {
            a = (a + block[i]) % 65521;
            b = (b + a) % 65521;
        }
    }
    check_bytes("values", seen, grey, sizeof grey);
    check_hex("Adler-32", big(data + 2 + 2 * 9), b << 16 | a);
}

/* ---- spectrum ---- */

#define TWO_PI 6.283185307179586

/* A tone on a bin has its mean square there and in the two beside it; a held offset is left out. */
TEST(afm_spectrum_tone)
{
    struct spectrum s;
    double sum = 0.0;
    check_true("memory", spectrum_init(&s, 256, 1e-3));
    for (int i = 0; i < 4096; i++)
        spectrum_add(&s, 5.0 + 3.0 * cos(TWO_PI * 40.0 * i / 256.0));
    spectrum_finish(&s);
    check_int("segments that overlap by half", (long long)s.segments, 31);
    for (size_t i = 38; i <= 42; i++)
        sum += s.density[i] * spectrum_frequency(&s, 1);
    check_near("mean square of the tone", sum, 4.5, 1e-9);
    check_near("offset", s.density[0], 0.0, 1e-12);
    check_near("frequency of its bin, Hz", spectrum_frequency(&s, 40), 156.25, 1e-12);
    spectrum_free(&s);
}

/* White noise of variance v over a band of fs/2 has the density 2 v/fs. */
TEST(afm_spectrum_white)
{
    struct spectrum s;
    unsigned long long word = 1;
    double mean = 0.0;
    check_true("memory", spectrum_init(&s, 512, 1e-4));
    for (int i = 0; i < 100000; i++) {
        word = word * 6364136223846793005ull + 1442695040888963407ull;
        spectrum_add(&s, (double)(word >> 40) / 16777216.0 - 0.5);
    }
    spectrum_finish(&s);
    for (size_t i = 2; i < 255; i++)
        mean += s.density[i] / 253.0;
    check_near("mean density over 2 v/fs", mean / (2.0 / 12.0 * 1e-4), 1.0, 4.0 * sqrt(2.0 / 100000.0));
    spectrum_free(&s);
}

TEST(afm_spectrum_fit)
{
    struct resonance truth = {70e3, 400.0, 4.6e-29, 0.0}, fit;
    struct spectrum s;
    check_true("memory", spectrum_init(&s, 65536, 1.0 / 1.12e6));
    s.segments = 1000000000;
    for (size_t i = 0; i <= 32768; i++)
        s.density[i] = resonance_density(&truth, spectrum_frequency(&s, i));
    check_true("found", spectrum_fit(&s, 66e3, 74e3, &fit));
    check_near("f0, Hz", fit.f0_Hz, 70e3, 1e-5);
    check_near("Q", fit.quality, 400.0, 1e-4);
    check_near("below the resonance", fit.low / 4.6e-29, 1.0, 1e-6);
    check_true("too few bins", !spectrum_fit(&s, 70e3, 70.05e3, &fit));
    check_true("beyond the band", !spectrum_fit(&s, 550e3, 600e3, &fit));
    for (size_t i = 0; i <= 32768; i++)
        s.density[i] = 1.0 + fabs(spectrum_frequency(&s, i) - 70e3);
    check_true("a valley is no resonance", !spectrum_fit(&s, 66e3, 74e3, &fit));
    spectrum_free(&s);
}
