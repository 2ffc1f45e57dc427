/* jobs.c - the file of a run: resumes it, takes rows from the processes (jobs_workers.c), writes them in
 * order. */
#include "host_sim/maps/jobs.h"

#include "host_sim/cli/clock.h"
#include "host_sim/cli/files.h"
#include "host_sim/commands.h"
#include "host_sim/maps/jobs_workers.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const struct option jobs_options[] = {
    {"out", "FILE", "rows as CSV; an interrupted run is resumed in its file (standard output)", OPTION_WRITES,
     .initial = NULL, .identity = IDENTITY_OUTSIDE},
    {"shard", "I/N",
     "only the I-th of N shares; auto: as Slurm's array tells; contactplant merge joins them (1/1)",
     OPTION_TEXT, .initial = "1/1", .identity = IDENTITY_OUTSIDE},
    {"cores", "N", "processes side by side (all cores)", OPTION_INTEGER, 1, JOBS_CORES, .initial = NULL,
     .identity = IDENTITY_OUTSIDE},
    {.name = NULL},
};

struct book {
    const struct jobs *j;
    FILE *out;
    const char *path; /* NULL: standard output */
    uint32_t run;
    struct share share;
    char line[SHARE_LINE];  /* tells the share, before its rows; "" for a whole run */
    int first, next, end;   /* jobs of this shard; next: whose rows come next */
    long rows, rows_before; /* in the file; those before the last job's */
    bool whole;             /* its last line is there */
    struct jobs_chain chain;
    char **waiting; /* [end - first] rows that came before their turn */
    bool *finished; /* [end - first] */
    double start_s, told_s;
    int kept, taken; /* pieces in the file at the start, and added since */
};

static const char begin_of_last[] = "# complete: ";

/* FNV-1a: its start, and its continuation over a text. */
static const uint32_t hash_start = 2166136261u;

uint32_t jobs_run_on(uint32_t hash, const char *text, size_t n)
{
    for (size_t i = 0; i < n; i++)
        hash = (hash ^ (unsigned char)text[i]) * 16777619u;
    return hash;
}

uint32_t jobs_run_number(const char *identity)
{
    return jobs_run_on(hash_start, identity, strlen(identity));
}

/* Continues the chain of checks over a row of this job. */
static uint32_t go_on(struct jobs_chain *c, int job, const char *row, size_t n)
{
    if (c->job != job)
        *c = (struct jobs_chain){job, hash_start};
    return c->check = jobs_run_on(c->check, row, n);
}

bool jobs_row_fits(struct jobs_chain *c, char *line)
{
    char check[16];
    char *last = strrchr(line, ',');
    int job, used = 0;
    if (sscanf(line, "%*8x,%d,%n", &job, &used) != 1 || last < line + used)
        return false;
    snprintf(check, sizeof check, ",%08x\n", (unsigned)go_on(c, job, line, (size_t)(last - line)));
    bool fits = !strcmp(last, check);
    strcpy(last, "\n");
    return fits;
}

/* A shard is empty where there are fewer jobs than shards. Returns the exit status. */
static int read_shard(struct book *b)
{
    int status = share_take(b->j->options, b->j->n, &b->share);
    b->first = b->next = b->share.first;
    b->end = b->share.end;
    if (status == STATUS_DONE && b->share.n > 1)
        share_tell(b->j->options, &b->share, b->j->n, "jobs", b->run, b->line);
    return status;
}

void jobs_last(long rows, char text[JOBS_LAST])
{
    char end[SHARE_END];
    share_end(rows, "rows", end);
    snprintf(text, JOBS_LAST, JOBS_SHARE "%s\n", end);
}

void jobs_header(const char *columns, char text[JOBS_LINE])
{
    snprintf(text, JOBS_LINE, "run,job,%s,check\n", columns);
}

/* True when the rest of the file is zeros. */
static bool only_zeros(FILE *f)
{
    int byte = 0;
    while (byte == 0)
        byte = fgetc(f);
    return byte == EOF;
}

/* Lines before the rows: the share's, and the header in the first share, even without jobs. */
static int n_fronts(const struct book *b)
{
    return (*b->line ? 1 : 0) + (b->share.i == 1);
}

/* The begin of line `number`. */
static void expect(const struct book *b, long number, char ours[JOBS_LINE])
{
    if (*b->line && number == 1)
        snprintf(ours, JOBS_LINE, JOBS_SHARE "%.*s", (int)strcspn(b->line, ":") + 1, b->line);
    else if (number == n_fronts(b))
        jobs_header(b->j->columns, ours);
    else
        snprintf(ours, JOBS_LINE, "%08x,", (unsigned)b->run);
}

/* One begins with the other. */
static bool agree(const char *line, const char *ours)
{
    size_t n = strlen(ours), length = strlen(line);
    return !strncmp(line, ours, length < n ? length : n);
}

/* Is this last line, which begins at `offset`, what an interrupted run of ours left? Then it may be
 * removed; a line of another file may not. A crash may leave zeros behind it, or behind the last whole
 * line. Moves the place in the file. */
static bool is_cut_off(const struct book *b, const char *line, long number, long offset)
{
    char ours[JOBS_LINE];
    expect(b, number, ours);
    bool begins = agree(line, ours) || (*b->line && number > n_fronts(b) && agree(line, begin_of_last));
    if (!begins || (!*line && offset == 0)) /* zeros alone could be anybody's */
        return false;
    return !fseek(b->out, offset + (long)strlen(line), SEEK_SET) && only_zeros(b->out);
}

/* The line without run and job. */
static const char *own_part(const char *line)
{
    return strchr(strchr(line, ',') + 1, ',') + 1;
}

static const char *const foreign = "not of this run and shard, and left as it is; give another --out";
static const char *const joined =
    "a line of a share, and left as it is; join shares by contactplant merge, or give another --out";
static const char *const missing =
    "rows are missing before this one, and left as it is; complete their shard, and join again";
static const char *const changed = "this row, or one before it, was changed or lost, and left as it is; cut "
                                   "the file off before this line, and the same command goes on from there";

/* Checks one whole row. NULL: b->next is its job, and *keep the offset at which the rows of this job
 * begin. Else says what is wrong. ended: the row before is the last one of its job. */
static const char *read_row(struct book *b, char *line, bool ended, long offset, long *keep)
{
    unsigned run;
    int job;
    if (sscanf(line, "%8x,%d,", &run, &job) != 2 || run != b->run || job < b->next || job >= b->end)
        return foreign;
    if (job > b->next + 1 || (job > b->next && !ended))
        return missing;
    if (job > b->next) {
        *keep = offset;
        b->rows_before = b->rows;
    }
    b->next = job;
    b->rows++;
    return jobs_row_fits(&b->chain, line) ? NULL : changed;
}

static const char *read_front(const struct book *b, const char *line, long number)
{
    char ours[JOBS_LINE];
    expect(b, number, ours);
    return strncmp(line, ours, strlen(ours)) ? foreign : NULL;
}

/* The last line of a share, with which nothing is left to compute. */
static const char *read_last(struct book *b, const char *line, bool ended)
{
    char ours[JOBS_LAST];
    jobs_last(b->rows, ours);
    bool all = b->first == b->end || (ended && b->next == b->end - 1);
    if (b->whole || !all || strcmp(line, ours) != 0)
        return changed;
    b->whole = true;
    b->next = b->end;
    return NULL;
}

/* Checks the rows of a file, of which the last may be torn. NULL: the run resumes at *keep. Else says what
 * is wrong with line *number. */
static const char *read_lines(struct book *b, char *line, long *keep, long *number)
{
    const char *wrong = NULL;
    bool ended = false;
    for (long offset = 0; !wrong && fgets(line, JOBS_LINE, b->out); offset = ftell(b->out)) {
        ++*number;
        if (!strchr(line, '\n'))
            return is_cut_off(b, line, *number, offset) ? NULL : foreign;
        if (*line == '#' && !*b->line)
            return joined;
        if (*number <= n_fronts(b)) {
            wrong = read_front(b, line, *number);
            *keep = *number == n_fronts(b) ? ftell(b->out) : 0;
            continue;
        }
        if (*line == '#' || b->whole) {
            wrong = read_last(b, line, ended);
            continue;
        }
        wrong = read_row(b, line, ended, offset, keep);
        ended = !wrong && (!b->j->ends || b->j->ends(b->j->context, b->next, own_part(line)));
    }
    return wrong;
}

/* The last job's rows begin at `keep`. Returns where those end that stay, or -1 without memory. */
static long keep_pieces(struct book *b, char *line, long keep)
{
    char *text = NULL;
    size_t size = 0, stay = 0;
    struct jobs_chain chain = JOBS_CHAIN;
    FILE *rows = open_memstream(&text, &size);
    bool good = rows && !fseek(b->out, keep, SEEK_SET);
    while (good && fgets(line, JOBS_LINE, b->out) && jobs_row_fits(&chain, line))
        fputs(own_part(line), rows);
    if (!rows || fclose(rows) || !good)
        return -1;
    stay = b->j->resume(b->j->context, b->next, text);
    good = !fseek(b->out, keep, SEEK_SET);
    for (size_t done = 0; good && done < stay; b->kept++, b->rows++) {
        good = fgets(line, JOBS_LINE, b->out) && jobs_row_fits(&b->chain, line);
        done += good ? strlen(own_part(line)) : 0;
    }
    free(text);
    return good ? ftell(b->out) : -1;
}

static int read_file(struct book *b)
{
    char line[JOBS_LINE];
    long keep = 0, number = 0;
    const char *wrong = read_lines(b, line, &keep, &number);
    if (wrong)
        return options_misuse(b->j->options->usage, "%s:%ld: %s", b->path, number, wrong);
    if (b->whole)
        return STATUS_DONE;
    b->chain = JOBS_CHAIN;
    b->rows = b->rows_before;
    if (b->j->resume)
        keep = keep_pieces(b, line, keep);
    if (keep < 0 || ftruncate(fileno(b->out), keep) || fseek(b->out, keep, SEEK_SET))
        return options_failure(b->j->options->usage, "%s: %s; give another --out", b->path, strerror(errno));
    return STATUS_DONE;
}

/* Locks the file: two processes would overwrite each other's rows. A file system without locks lets both
 * in. */
static int take_file(struct book *b)
{
    struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    struct stat s;
    if (fstat(fileno(b->out), &s) || !S_ISREG(s.st_mode))
        return options_failure(
            b->j->options->usage,
            "--out %s: no file on a disk; give one, or leave --out out for standard output", b->path);
    if (!fcntl(fileno(b->out), F_SETLK, &whole) || (errno != EACCES && errno != EAGAIN))
        return STATUS_DONE;
    return options_failure(b->j->options->usage,
                           "--out %s: another process writes it; wait for that one, or give another file",
                           b->path);
}

/* Writes into the file, or to standard output and its copy. */
static void put_text(const struct book *b, const char *text)
{
    fputs(text, b->out);
    if (!b->path && b->j->copy)
        fputs(text, b->j->copy);
}

static int open_file(struct book *b)
{
    char header[JOBS_LINE];
    b->path = options_text(b->j->options, "out", 0);
    b->out = b->path ? files_resume(b->path) : stdout;
    if (!b->out)
        return options_misuse(b->j->options->usage, "--out %s: %s; give a file that can be written", b->path,
                              strerror(errno));
    int status = b->path ? take_file(b) : STATUS_DONE;
    status = status == STATUS_DONE && b->path ? read_file(b) : status;
    if (status != STATUS_DONE || (b->path && ftell(b->out) != 0))
        return status;
    jobs_header(b->j->columns, header);
    if (*b->line) {
        put_text(b, JOBS_SHARE);
        put_text(b, b->line);
        put_text(b, "\n");
    }
    if (b->share.i == 1)
        put_text(b, header);
    (void)fflush(b->out); /* though the first row be long in coming, the file tells its share */
    return status;
}

/* Writes rows of job b->next, each with run and job in front and check behind. */
static void write_rows(struct book *b, const char *text)
{
    char front[32], line[JOBS_LINE];
    int length = snprintf(front, sizeof front, "%08x,%d,", (unsigned)b->run, b->next);
    while (*text) {
        size_t n = strcspn(text, "\n");
        go_on(&b->chain, b->next, front, (size_t)length);
        unsigned check = go_on(&b->chain, b->next, text, n);
        snprintf(line, sizeof line, "%s%.*s,%08x\n", front, (int)n, text, check);
        put_text(b, line);
        b->rows++;
        text += n + (text[n] == '\n');
    }
}

static void tell_progress(struct book *b)
{
    double now = clock_now_s(), each = isatty(STDERR_FILENO) ? 1.0 : 10.0;
    int parts = b->j->parts > 0 ? b->j->parts : 1, all = (b->end - b->first) * parts,
        done = b->kept + b->taken;
    if (now - b->told_s < each || b->taken == 0)
        return;
    double left = (now - b->start_s) * (all - done) / b->taken;
    fprintf(stderr, "contactplant %s: %d of %d, %.0f s left%s", b->j->options->usage->name, done, all, left,
            isatty(STDERR_FILENO) ? "   \r" : "\n");
    b->told_s = now;
}

/* Appends text to the waiting one. NULL without memory. Takes both. */
static char *join(char *waiting, char *text)
{
    if (!waiting)
        return text;
    size_t n = strlen(waiting);
    char *both = realloc(waiting, n + strlen(text) + 1);
    if (both)
        strcpy(both + n, text);
    free(text);
    return both;
}

/* Takes rows from a process and writes what is next in order. False when they cannot be written. */
static bool take_rows(void *context, int job, char *text, bool last)
{
    struct book *b = context;
    int i = job - b->first;
    b->waiting[i] = join(b->waiting[i], text);
    b->finished[i] = last;
    b->taken += b->j->parts == 0 || !last;
    if (!b->waiting[i])
        return false;
    for (i = b->next - b->first; b->next < b->end && b->waiting[i]; i++, b->next++) {
        write_rows(b, b->waiting[i]);
        free(b->waiting[i]);
        b->waiting[i] = NULL;
        if (!b->finished[i])
            break;
    }
    tell_progress(b);
    return !fflush(b->out);
}

static int compute_all(struct book *b)
{
    const struct usage *u = b->j->options->usage;
    char why[JOBS_REASON] = "";
    double cores = options_number(b->j->options, "cores");
    if (b->next == b->end)
        return STATUS_DONE;
    b->waiting = calloc((size_t)(b->end - b->first), sizeof *b->waiting);
    b->finished = calloc((size_t)(b->end - b->first), sizeof *b->finished);
    if (!b->waiting || !b->finished)
        return options_failure(u, "out of memory");
    b->start_s = b->told_s = clock_now_s();
    b->kept += (b->next - b->first) * (b->j->parts > 0 ? b->j->parts : 1);
    const struct workers w = {
        .compute = b->j->compute,
        .context = b->j->context,
        .take = take_rows,
        .taker = b,
        .next = b->next,
        .end = b->end,
        .n = cores > 0.0 ? (int)cores : workers_cores(),
    };
    bool good = workers_run(&w, why);
    for (int i = 0; i < b->end - b->first; i++)
        free(b->waiting[i]);
    free(b->waiting);
    free(b->finished);
    if (good || (!b->path && options_reader_left()))
        return STATUS_DONE;
    return options_failure(u, "%s; %d of %d jobs are done%s", why, b->next - b->first, b->end - b->first,
                           b->path ? ", and the same command goes on from there" : "");
}

int jobs_run(const struct jobs *j)
{
    struct book b = {.j = j, .run = jobs_run_number(j->identity), .chain = JOBS_CHAIN};
    int status = read_shard(&b);
    if (status == STATUS_DONE)
        status = open_file(&b);
    if (status == STATUS_DONE)
        status = compute_all(&b);
    if (status == STATUS_DONE && *b.line && !b.whole && b.next == b.end) {
        char last[JOBS_LAST];
        jobs_last(b.rows, last);
        put_text(&b, last);
    }
    bool unwritten = b.path && b.out && !files_finish(b.out, true);
    if (status == STATUS_DONE && unwritten)
        status = options_failure(j->options->usage, "%s: %s; then give the same command", b.path,
                                 files_unwritten(errno));
    return status;
}
