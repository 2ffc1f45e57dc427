/* test_jobs.c - computations over processes: the bytes of the
 * file depend on neither cores, shards nor interruptions. */
#include "host_sim/commands.h"
#include "host_sim/maps/jobs.h"
#include "host_sim/version.h"
#include "tests/unit/test.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { N_JOBS = 23, BYTES = 4096 };

static const struct usage jobs_usage = {.name = "test", .table = {jobs_options}};

struct trouble {
    int fails, dies; /* the job that does, or -1 */
};

/* Job i has 1 + i % 3 rows of its square. */
static bool compute(void *context, int i, FILE *rows)
{
    const struct trouble *t = context;
    if (i == t->dies)
        _exit(1);
    if (i == t->fails) {
        fprintf(rows, "no square today");
        return false;
    }
    for (int k = 0; k <= i % 3; k++)
        fprintf(rows, "%d,%d\n", k, i * i);
    return true;
}

static bool ends(void *context, int i, const char *row)
{
    (void)context;
    return atoi(row) == i % 3;
}

/* Runs `j` with these options. */
static int run_with(struct jobs *j, const char *out, const char *shard, const char *cores)
{
    char text[4][64] = {"test"};
    char *argv[] = {text[0], text[1], text[2], text[3]};
    snprintf(text[1], sizeof text[1], "--out=%s", out);
    snprintf(text[2], sizeof text[2], "--shard=%s", shard);
    snprintf(text[3], sizeof text[3], "--cores=%s", cores);
    struct options o;
    int status;
    if (!options_parse(&o, &jobs_usage, 4, argv, &status))
        return status;
    j->options = &o;
    return jobs_run(j);
}

static int run_jobs(const char *identity, const char *out, const char *shard, const char *cores,
                    struct trouble t)
{
    struct jobs j = {.identity = identity,
                     .columns = "row,square",
                     .n = N_JOBS,
                     .compute = compute,
                     .ends = ends,
                     .context = &t};
    return run_with(&j, out, shard, cores);
}

static const struct trouble none = {-1, -1};

static size_t read_text(const char *path, char *text)
{
    FILE *f = fopen(path, "r");
    size_t n = f ? fread(text, 1, BYTES - 1, f) : 0;
    if (f)
        fclose(f);
    text[n] = '\0';
    return n;
}

static void write_text(const char *path, const char *text, size_t n)
{
    FILE *f = fopen(path, "w");
    check_true("a file can be written", f && fwrite(text, 1, n, f) == n);
    if (f)
        fclose(f);
}

static char jobs_directory[] = "/tmp/contactplant_jobs_XXXXXX", jobs_file[64];

/* The whole file of the run, from one process. */
static size_t whole_run(char *text)
{
    check_true("a directory of its own",
               mkdtemp(strcpy(jobs_directory, "/tmp/contactplant_jobs_XXXXXX")) != NULL);
    snprintf(jobs_file, sizeof jobs_file, "%s/jobs.csv", jobs_directory);
    check_int("a run ends well", run_jobs("a", jobs_file, "1/1", "1", none), STATUS_DONE);
    return read_text(jobs_file, text);
}

static void clear(void)
{
    unlink(jobs_file);
    rmdir(jobs_directory);
}

/* Adds the lines of a share between the two that begin with #. */
static void add_rows(char *joined, const char *part)
{
    const char *rows = strchr(part, '\n'), *last = strstr(part, "# complete: ");
    if (rows && last)
        strncat(joined, rows + 1, (size_t)(last - rows - 1));
}

TEST(jobs_order)
{
    char one[BYTES], three[BYTES], expected[BYTES], rows[BYTES];
    int n = sprintf(expected, "run,job,row,square,check\n");
    for (int i = 0; i < N_JOBS; i++)
        for (int k = 0, so_far = 0; k <= i % 3;
             k++) { /* a check is the hash of all rows of its job up to it */
            int row = sprintf(rows + so_far, "%08x,%d,%d,%d", (unsigned)jobs_run_number("a"), i, k, i * i);
            n += sprintf(expected + n, "%s,%08x\n", rows + so_far, (unsigned)jobs_run_number(rows));
            so_far += row;
        }
    check_int("bytes of the file", (int)whole_run(one), n);
    check_string("rows are in the order of their jobs", one, expected);
    unlink(jobs_file);
    check_int("five processes", run_jobs("a", jobs_file, "1/1", "5", none), STATUS_DONE);
    read_text(jobs_file, three);
    check_string("five processes write the same bytes", one, three);
    check_int("run number of \"a\": FNV-1a's published value", (int)(jobs_run_number("a") == 0xe40c292cu), 1);
    clear();
}

TEST(jobs_shards)
{
    char text[BYTES], joined[BYTES] = "", part[BYTES], shard[16];
    whole_run(text);
    for (int i = 1; i <= 4; i++) {
        unlink(jobs_file);
        sprintf(shard, "%d/4", i);
        check_int(shard, run_jobs("a", jobs_file, shard, "2", none), STATUS_DONE);
        read_text(jobs_file, part);
        add_rows(joined, part);
    }
    check_string("the rows of four shards are the whole file", text, joined);
    check_int("the file of another shard is refused", run_jobs("a", jobs_file, "2/4", "2", none),
              STATUS_MISUSED);
    static const char *const wrong[] = {"0/4",  "5/4", "1",    "1/",  "/4",           "24/23",
                                        "1/4x", "",    "-1/4", "1/0", "1/99999999999"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        check_int(wrong[i], run_jobs("a", jobs_file, wrong[i], "1", none), STATUS_MISUSED);
    read_text(jobs_file, joined);
    check_string("what is refused changes nothing", joined, part);
    clear();
}

/* More shards than jobs: some files have no row, and all of them together have those of the whole one. */
TEST(jobs_empty_shards)
{
    enum { SHARDS = 3 * N_JOBS + 1 };
    char text[BYTES], joined[BYTES] = "", part[BYTES], shard[16];
    int failed = 0, empty = 0;
    whole_run(text);
    for (int i = 1; i <= SHARDS; i++) {
        unlink(jobs_file);
        sprintf(shard, "%d/%d", i, SHARDS);
        failed += run_jobs("a", jobs_file, shard, "1", none) != STATUS_DONE;
        failed +=
            run_jobs("a", jobs_file, shard, "1", none) != STATUS_DONE; /* gone on with, complete as it is */
        read_text(jobs_file, part);
        empty += strstr(part, "\n# complete: 0 rows\n") != NULL;
        add_rows(joined, part);
    }
    check_int("shards that failed", failed, 0);
    check_int("complete without a row: all that have no job", empty, SHARDS - N_JOBS);
    check_string("their rows are the whole file", text, joined);
    clear();
}

/* A share tells itself before its rows, and with its last line that it is whole. Cut off anywhere it goes on
 * to the same bytes; without a row, or with rows that the last line does not count, it is refused. */
TEST(jobs_share_lines)
{
    char text[BYTES], part[BYTES], again[BYTES], first[200];
    int failed = 0, wrong = 0, taken = 0;
    whole_run(text);
    unlink(jobs_file);
    check_int("the second of four", run_jobs("a", jobs_file, "2/4", "2", none), STATUS_DONE);
    size_t n = read_text(jobs_file, part);
    snprintf(first, sizeof first, "# share 2/4 of 23 jobs, run e40c292c, contactplant %s: contactplant test",
             VERSION_TEXT);
    check_true(first, !strncmp(part, first, strlen(first)));
    check_true("its rows are counted", strstr(part, "\n# complete: 12 rows\n") != NULL);
    for (size_t at = 0; at < n; at++) {
        write_text(jobs_file, part, at);
        failed += run_jobs("a", jobs_file, "2/4", "2", none) != STATUS_DONE;
        read_text(jobs_file, again);
        wrong += strcmp(part, again) != 0;
    }
    check_int("cut off at any byte, not gone on with", failed, 0);
    check_int("to other bytes", wrong, 0);
    for (char *row = strchr(part, '\n') + 1; *row != '#'; row = strchr(row, '\n') + 1) {
        size_t end = strcspn(row, "\n") + 1;
        snprintf(again, sizeof again, "%.*s%s", (int)(row - part), part, row + end);
        write_text(jobs_file, again, strlen(again));
        taken += run_jobs("a", jobs_file, "2/4", "2", none) != STATUS_MISUSED;
    }
    check_int("without one of its rows, taken", taken, 0);
    snprintf(again, sizeof again, "%s%s", part, strchr(part, '\n') + 1);
    write_text(jobs_file, again, strlen(again));
    check_int("more behind the last line", run_jobs("a", jobs_file, "2/4", "2", none), STATUS_MISUSED);
    clear();
}

/* A power cut may leave zeros where the last bytes should be. */
TEST(jobs_zeros)
{
    char text[BYTES], again[BYTES], torn[2 * BYTES + 64];
    size_t n = whole_run(text);
    static const size_t zeros[] = {1, 7, BYTES - 1, BYTES, BYTES + 50};
    int different = 0, failed = 0, taken = 0;
    for (size_t cut = 1; cut <= n; cut += 13) { /* all of zeros[] in turn */
        size_t more = zeros[cut % 5];
        memset(torn, 0, sizeof torn);
        memcpy(torn, text, cut);
        write_text(jobs_file, torn, cut + more);
        failed += run_jobs("a", jobs_file, "1/1", "2", none) != STATUS_DONE;
        read_text(jobs_file, again);
        different += strcmp(text, again) != 0;
        torn[cut + more] = 'x'; /* something behind the zeros: no power cut does that */
        write_text(jobs_file, torn, cut + more + 1);
        taken += run_jobs("a", jobs_file, "1/1", "2", none) == STATUS_DONE;
    }
    check_int("files that end with zeros and were refused", failed, 0);
    check_int("resumed files that differ", different, 0);
    check_int("files with something behind the zeros that were taken", taken, 0);
    memset(torn, 0, sizeof torn);
    write_text(jobs_file, torn, 100);
    check_int("zeros alone are nobody's", run_jobs("a", jobs_file, "1/1", "2", none), STATUS_MISUSED);
    clear();
}

/* A file cut off anywhere is gone on with to the same bytes. */
TEST(jobs_resume)
{
    char text[BYTES], again[BYTES];
    size_t n = whole_run(text);
    int different = 0, failed = 0;
    for (size_t cut = 0; cut <= n; cut += 17) {
        write_text(jobs_file, text, cut);
        failed += run_jobs("a", jobs_file, "1/1", "2", none) != STATUS_DONE;
        read_text(jobs_file, again);
        different += strcmp(text, again) != 0;
    }
    check_int("resumed runs that failed", failed, 0);
    check_int("resumed files that differ", different, 0);
    clear();
}

TEST(jobs_other_file)
{
    char text[BYTES], again[BYTES];
    static const char *const foreign[] = {"hello",
                                          "hello\n",
                                          "run,job,row,square,check\nhello",
                                          "run,job,row\n",
                                          "run,job,row,square,check\n00000000,0,1,2,00000000\n",
                                          "time,x\n1,2\n"};
    whole_run(text);
    check_int("the file of another run is refused", run_jobs("b", jobs_file, "1/1", "2", none),
              STATUS_MISUSED);
    read_text(jobs_file, again);
    check_string("and left as it is", text, again);
    for (size_t i = 0; i < sizeof foreign / sizeof foreign[0]; i++) {
        write_text(jobs_file, foreign[i], strlen(foreign[i]));
        check_int("a foreign file is refused", run_jobs("a", jobs_file, "1/1", "2", none), STATUS_MISUSED);
        read_text(jobs_file, again);
        check_string("left as it is", foreign[i], again);
    }
    static const char zeros[] = "\0\0a file of something else", late[] = "r\0\0and so is this";
    write_text(jobs_file, zeros, sizeof zeros);
    check_int("a foreign file that begins with zeros", run_jobs("a", jobs_file, "1/1", "2", none),
              STATUS_MISUSED);
    check_int("its bytes", (int)read_text(jobs_file, again), (int)sizeof zeros);
    write_text(jobs_file, late, sizeof late);
    check_int("one that begins as ours", run_jobs("a", jobs_file, "1/1", "2", none), STATUS_MISUSED);
    check_int("its bytes", (int)read_text(jobs_file, again), (int)sizeof late);
    check_int("a file that cannot be", run_jobs("a", "/nowhere/jobs.csv", "1/1", "1", none), STATUS_MISUSED);
    check_int("a file that cannot be written", run_jobs("a", "/dev/full", "1/1", "1", none), STATUS_FAILED);
    clear();
}

/* A byte of a row that is not as it was written is found, and so are rows that left, moved, or came twice. */
TEST(jobs_changed)
{
    char text[BYTES], other[BYTES], again[BYTES];
    size_t n = whole_run(text), header = strcspn(text, "\n") + 1;
    int taken = 0, changed = 0, tries = 0;
    for (size_t at = header; at < n; at += 3) {
        if (text[at] == '\n')
            continue;
        memcpy(other, text, n + 1);
        other[at] = other[at] == '1' ? '7' : '1';
        write_text(jobs_file, other, n);
        taken += run_jobs("a", jobs_file, "1/1", "1", none) != STATUS_MISUSED;
        read_text(jobs_file, again);
        changed += strcmp(other, again) != 0;
    }
    for (size_t at = header; at < n; at += strcspn(text + at, "\n") + 1) {
        size_t row = strcspn(text + at, "\n") + 1, next = strcspn(text + at + row, "\n") + 1;
        if (at + row + next >= n)
            break; /* a last row that left is as after an interruption */
        sprintf(other, "%.*s%s", (int)at, text, text + at + row);
        sprintf(other + BYTES / 2, "%.*s%.*s%.*s%s", (int)at, text, (int)next, text + at + row, (int)row,
                text + at, text + at + row + next);
        for (int moved = 0; moved < 2; moved++, tries++) {
            const char *wrong = other + moved * (BYTES / 2);
            write_text(jobs_file, wrong, strlen(wrong));
            taken += run_jobs("a", jobs_file, "1/1", "1", none) != STATUS_MISUSED;
            read_text(jobs_file, again);
            changed += strcmp(wrong, again) != 0;
        }
        sprintf(other, "%.*s%s", (int)(at + row), text, text + at);
        write_text(jobs_file, other, strlen(other));
        taken += run_jobs("a", jobs_file, "1/1", "1", none) != STATUS_MISUSED;
    }
    check_is("rows", tries, >, 2 * N_JOBS);
    check_int("changed files that were taken", taken, 0);
    check_int("or written to", changed, 0);
    clear();
}

/* A file that another process writes is left to it. */
TEST(jobs_locked)
{
    char text[BYTES], again[BYTES], byte;
    int ready[2], done[2];
    whole_run(text);
    check_true("pipes", !pipe(ready) && !pipe(done));
    pid_t other = fork();
    if (other == 0) {
        struct flock all = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
        bool held = fcntl(open(jobs_file, O_RDWR), F_SETLK, &all) == 0;
        _exit(!held || write(ready[1], "x", 1) != 1 || read(done[0], &byte, 1) != 1);
    }
    check_int("the other one has it", (int)read(ready[0], &byte, 1), 1);
    check_int("refused", run_jobs("a", jobs_file, "1/1", "2", none), STATUS_FAILED);
    check_int("told to end", (int)write(done[1], "x", 1), 1);
    waitpid(other, NULL, 0);
    read_text(jobs_file, again);
    check_string("left as it is", text, again);
    check_int("free again", run_jobs("a", jobs_file, "1/1", "2", none), STATUS_DONE);
    for (int i = 0; i < 2; i++)
        close(ready[i]), close(done[i]);
    clear();
}

/* Before each job some bytes are left out, as of a shard that
 * was not complete, or not there, when files were joined. */
TEST(jobs_gaps)
{
    char text[BYTES], holed[BYTES], again[BYTES];
    int taken = 0, changed = 0, tries = 0;
    whole_run(text);
    size_t header = strcspn(text, "\n") + 1, n = strlen(text);
    for (size_t at = header + 1; at < n; at++) {
        if (text[at - 1] != '\n' || atoi(strchr(strchr(text + at, ',') + 1, ',') + 1) != 0)
            continue; /* not the first row of a job */
        for (size_t cut = 1; cut <= 80 && cut <= at - header; cut += 7, tries++) {
            sprintf(holed, "%.*s%s", (int)(at - cut), text, text + at);
            write_text(jobs_file, holed, strlen(holed));
            taken += run_jobs("a", jobs_file, "1/1", "1", none) != STATUS_MISUSED;
            read_text(jobs_file, again);
            changed += strcmp(holed, again) != 0;
        }
    }
    check_is("holes", tries, >, 150);
    check_int("files with a hole that were taken", taken, 0);
    check_int("or changed", changed, 0);
    clear();
}

/* A failure ends the run and keeps the rows before it. Without the trouble the run resumes and makes an
 * equal file. */
TEST(jobs_trouble)
{
    char text[BYTES], again[BYTES];
    const struct trouble trouble[] = {{11, -1}, {-1, 11}};
    whole_run(text);
    for (int i = 0; i < 2; i++) {
        unlink(jobs_file);
        check_int("a job that fails", run_jobs("a", jobs_file, "1/1", "2", trouble[i]), STATUS_FAILED);
        size_t kept = read_text(jobs_file, again);
        check_is("earlier rows are kept", kept, >, 0);
        check_true("earlier rows are kept", !strncmp(text, again, kept));
        check_int("gone on with", run_jobs("a", jobs_file, "1/1", "2", none), STATUS_DONE);
        read_text(jobs_file, again);
        check_string("the whole file", text, again);
    }
    clear();
}

/* ---- pieces ---- */

enum { PIECES = 5 };

struct pieces {
    int job, done; /* when resuming: where the file stands */
};

/* A piece is two rows. */
static bool compute_pieces(void *context, int i, FILE *rows)
{
    const struct pieces *p = context;
    for (int k = i == p->job ? p->done : 0; k < PIECES; k++) {
        fprintf(rows, "%d,%d\n%d,%d\n", 2 * k, i, 2 * k + 1, i * i);
        jobs_piece(rows);
    }
    return true;
}

static size_t resume_pieces(void *context, int i, const char *rows)
{
    struct pieces *p = context;
    size_t stay = 0, at = 0;
    p->job = i;
    for (int line = 1; rows[at]; line++) {
        at += strcspn(rows + at, "\n") + 1;
        if (line % 2 == 0)
            stay = at, p->done++;
    }
    return stay;
}

static int run_pieces(const char *cores)
{
    struct pieces p = {-1, 0};
    struct jobs j = {.identity = "pieces",
                     .columns = "row,square",
                     .n = 4,
                     .compute = compute_pieces,
                     .context = &p,
                     .parts = PIECES,
                     .resume = resume_pieces};
    return run_with(&j, jobs_file, "1/1", cores);
}

/* Jobs in pieces from several processes, cut off anywhere and gone on with inside a job: the same bytes. */
TEST(jobs_pieces)
{
    char text[BYTES], again[BYTES];
    int different = 0, failed = 0;
    whole_run(text);
    unlink(jobs_file);
    check_int("one process", run_pieces("1"), STATUS_DONE);
    size_t n = read_text(jobs_file, text);
    check_int("rows", (int)(n > 0 && strstr(text, ",3,9,9,") != NULL), 1);
    for (size_t cut = 0; cut <= n; cut += 11) {
        write_text(jobs_file, text, cut);
        failed += run_pieces("3") != STATUS_DONE;
        read_text(jobs_file, again);
        different += strcmp(text, again) != 0;
    }
    check_int("resumed runs that failed", failed, 0);
    check_int("resumed files that differ", different, 0);
    clear();
}
