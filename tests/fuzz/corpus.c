/* corpus.c - runs a fuzz target over files, without a fuzzer: 0 when all of them could be read. */
#include "tests/fuzz/fuzz.h"

static int run_file(const char *path)
{
    static uint8_t data[1 << 17];
    FILE *f = fopen(path, "rb");
    if (!f)
        return 0;
    size_t n = fread(data, 1, sizeof data, f);
    fclose(f);
    uint8_t *exact = malloc(n ? n : 1); /* so that the sanitizer sees a byte too far */
    for (size_t i = 0; exact && i < n; i++)
        exact[i] = data[i];
    if (exact)
        LLVMFuzzerTestOneInput(exact, n);
    free(exact);
    return 1;
}

int main(int argc, char **argv)
{
    int n = 0;
    for (int i = 1; i < argc; i++)
        n += run_file(argv[i]);
    return n == argc - 1 && n > 0 ? 0 : 1;
}
