/* corpus.c - runs a fuzz target over a packed corpus (tests/fuzz/pack.py), without a fuzzer; prints how many
 * inputs it was. 0 when there is at least one and every line could be read. */
#include "tests/fuzz/fuzz.h"

#include <string.h>
#include <sys/types.h>

static int digit(char c)
{
    const char *digits = "0123456789abcdef", *at = c ? strchr(digits, c) : NULL;
    return at ? (int)(at - digits) : -1;
}

/* An input that fills its memory exactly, so that the sanitizer
 * sees a byte too far; NULL for a line that is no input. */
static uint8_t *input_of(const char *line, size_t digits)
{
    if (digits % 2)
        return NULL;
    uint8_t *data = malloc(digits ? digits / 2 : 1);
    for (size_t i = 0; data && i < digits; i += 2) {
        int high = digit(line[i]), low = digit(line[i + 1]);
        if (high < 0 || low < 0) {
            free(data);
            return NULL;
        }
        data[i / 2] = (uint8_t)(16 * high + low);
    }
    return data;
}

/* How many inputs were run, or -1 with the reason on stderr. */
static int run_file(const char *path)
{
    FILE *f = fopen(path, "r");
    char *line = NULL;
    size_t room = 0;
    ssize_t n;
    int inputs = 0;
    if (!f) {
        perror(path);
        return -1;
    }
    while ((n = getline(&line, &room, f)) >= 0) {
        size_t digits = (size_t)n - (n > 0 && line[n - 1] == '\n');
        uint8_t *data = input_of(line, digits);
        if (!data) {
            fprintf(stderr, "%s:%d: not an input in hexadecimal\n", path, inputs + 1);
            inputs = -1;
            break;
        }
        LLVMFuzzerTestOneInput(data, digits / 2);
        free(data);
        inputs++;
    }
    free(line);
    fclose(f);
    return inputs;
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fprintf(stderr, "usage: %s CORPUS.hex\n", argv[0]);
        return 2;
    }
    int inputs = run_file(argv[1]);
    printf("%d\n", inputs);
    return inputs < 1;
}
