/* test_rows.c - rows by a table of columns: header, text,
 * and back to the same bits; what is no row is refused. */
#include "host_sim/commands.h"
#include "host_sim/maps/rows.h"
#include "tests/unit/test.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct own {
    int count;
    enum { GOOD, BAD } outcome;
    double value, exact, item[2];
    uint64_t turns[2];
};

static const char *const outcomes[] = {"good", "bad", NULL};

#define AT(member) .offset = offsetof(struct own, member)

static const struct rows_column own_columns[] = {
    {"count", "", "", ROWS_COUNT, AT(count)},
    {"outcome", "", "", ROWS_WORD, AT(outcome), .words = outcomes},
    {"speed", "m/s", "", ROWS_NUMBER, 4, AT(value), .factor = 100.0},
    {"exact", "1", "", ROWS_NUMBER, 0, AT(exact)},
    {"mean_", "N", "", ROWS_NUMBER, 17, AT(item)},
    {"phases", "", "", ROWS_TURNS, AT(turns), .count = 2},
};

static struct rows table;

static void describe(void)
{
    rows_begin(&table, sizeof(struct own));
    for (int i = 0; i < 4; i++)
        rows_add(&table, &own_columns[i]);
    table.n_given = 2;
    rows_add_item(&table, &own_columns[4], 0, "force");
    rows_add_item(&table, &own_columns[4], 1, "1/2");
    rows_add(&table, &own_columns[5]);
}

static void write_row(const struct own *row, bool result, char text[256])
{
    FILE *f = fmemopen(text, 256, "w");
    rows_write(&table, row, result, f);
    fclose(f);
}

static const struct own own_row = {3, BAD, 0.0123456, 0.1, {1.0 / 3.0, -2.0}, {0x8000000000000000u, 1}};
static const char own_line[] = "3,bad,1.235,0.1,0.33333333333333331,-2,8000000000000000:0000000000000001\n";

TEST(rows_write)
{
    char text[256];
    describe();
    check_string("header", table.header, "count,outcome,speed_m_per_s,exact,mean_force_N,mean_1/2_N,phases");
    write_row(&own_row, true, text);
    check_string("a row", text, own_line);
    write_row(&own_row, false, text);
    check_string("a row without a result", text, "3,bad,,,,,\n");
    check_string("the column of a value", rows_find(&table, offsetof(struct own, exact))->name, "exact");
}

TEST(rows_read)
{
    struct own back;
    describe();
    check_true("a row reads back", rows_read(&table, own_line, &back));
    check_int("count", back.count, 3);
    check_int("word", (int)back.outcome, BAD);
    check_is("a number in the row's unit", back.value, ==, 1.235 / 100.0);
    check_is("a number in full", back.item[0], ==, 1.0 / 3.0);
    check_is("all of it without digits", back.exact, ==, 0.1);
    check_true("turns, every bit", !memcmp(back.turns, own_row.turns, sizeof own_row.turns));
    check_true("a row without a result, as before", rows_read(&table, "3,bad,nan,nan,nan,nan,nan\n", &back));
    check_true("has no number", isnan(back.value) && isnan(back.item[1]) && back.turns[0] == 0);
    check_true("a row without a result", rows_read(&table, "3,bad,,,,,\n", &back));
    check_true("has no number", isnan(back.value) && isnan(back.item[1]) && back.turns[0] == 0);
}

TEST(rows_refuse)
{
    static const char *const wrong[] = {
        "",
        "\n",
        "3,bad,1,0.1,0.3,-2\n",
        "3,bad,1,0.1,0.3,-2,8000000000000000\n",
        "3,bad,1,0.1,0.3,-2,8000000000000000:0000000000000001:1\n",
        "3,bad,1,0.1,0.3,-2,8000000000000000:0000000000000001,1\n",
        "3,bad,1,0.1,0.3,-2,8000000000000000:0000000000000001",
        "3,worse,1,0.1,0.3,-2,8000000000000000:0000000000000001\n",
        "3,ba,1,0.1,0.3,-2,8000000000000000:0000000000000001\n",
        "3,,1,0.1,0.3,-2,8000000000000000:0000000000000001\n",
        ",bad,1,0.1,0.3,-2,8000000000000000:0000000000000001\n",
        "3,bad,one,0.1,0.3,-2,8000000000000000:0000000000000001\n",
        "3,bad,1,0.1,0.3,\n-2,8000000000000000:0000000000000001\n",
        "3.5,bad,1,0.1,0.3,-2,8000000000000000:0000000000000001\n",
    };
    struct own back;
    describe();
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        check_int(wrong[i], rows_read(&table, wrong[i], &back), false);
}

/* ---- files ---- */

static const struct usage rows_usage = {.name = "test"};
static const struct options options = {.usage = &rows_usage};
static char rows_file[] = "/tmp/contactplant_rows_XXXXXX";

/* Two jobs of run 7 with two rows each, as jobs.h says:
 * a check is the hash of all rows of its job up to it. */
static void write_file(const char *header, const char *first, const char *other_run, int n)
{
    char so_far[1024] = "";
    FILE *f = fopen(rows_file, "w");
    fputs(header, f);
    for (int i = 0; i < n; i++) {
        char text[256];
        int length = snprintf(text, sizeof text, "%s,%d,%.*s", i == n - 1 ? other_run : "00000007", i / 2,
                              (int)strlen(own_line) - 1, own_line);
        if (i % 2 == 0)
            *so_far = '\0';
        strcat(so_far, text);
        fprintf(f, "%.*s,%08x\n", length, i == 0 && first ? first : text, (unsigned)jobs_run_number(so_far));
    }
    fclose(f);
}

static int load(int *n)
{
    struct rows_table t;
    int status = rows_load(&options, &table, rows_file, &t);
    *n = t.n;
    for (int i = 0; i < t.n && status == STATUS_DONE; i++) {
        const struct own *back = rows_row(&t, i);
        check_int("job", t.job[i], i / 2);
        check_is("number", back->item[0], ==, 1.0 / 3.0);
    }
    rows_free(&t);
    return status;
}

TEST(rows_load)
{
    char header[JOBS_LINE];
    int n, file = mkstemp(strcpy(rows_file, "/tmp/contactplant_rows_XXXXXX"));
    close(file);
    describe();
    jobs_header(table.header, header);
    write_file(header, NULL, "00000007", 4);
    check_int("a file", load(&n), STATUS_DONE);
    check_int("rows", n, 4);
    write_file("run,job,count,check\n", NULL, "00000007", 4);
    check_int("another header", load(&n), STATUS_MISUSED);
    write_file(header, NULL, "00000007", 0);
    check_int("no rows", load(&n), STATUS_MISUSED);
    write_file(header, NULL, "00000008", 4);
    check_int("a row of another run", load(&n), STATUS_MISUSED);
    check_int("rows before it", n, 3);
    write_file(header, "00000007,0,4,bad,1.235,0.1,0.33333333333333331,-2,8000000000000000:0000000000000001",
               "00000007", 4);
    check_int("a row that was changed", load(&n), STATUS_MISUSED);
    check_int("rows before it", n, 0);
    unlink(rows_file);
    check_int("no file", load(&n), STATUS_MISUSED);
}
