/* test_files.c - the guard of a command line: which outputs are inputs or other outputs, and how a file is
 * written. */
#include "host_sim/cli/files.h"
#include "host_sim/cli/options.h"
#include "tests/unit/test.h"

#include <errno.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PATH = 256 };

static char folder[PATH];

/* The path of a file in the test's folder. */
static const char *at(const char *name)
{
    static char path[8][PATH + 32];
    static int i;
    i = (i + 1) % 8;
    snprintf(path[i], sizeof path[i], "%s/%s", folder, name);
    return path[i];
}

static void begin(void)
{
    snprintf(folder, sizeof folder, "%s/files.XXXXXX", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
    check_true("a folder", mkdtemp(folder) != NULL);
    files_begin();
}

static void end(void)
{
    char command[PATH + 16];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    check_int("the folder goes", system(command), 0);
    files_begin();
}

static void put(const char *path, const char *text)
{
    FILE *f = fopen(path, "w");
    check_true("a file of the test", f && fputs(text, f) >= 0 && !fclose(f));
}

static const char *content(const char *path)
{
    static char text[64];
    FILE *f = fopen(path, "r");
    size_t n = f ? fread(text, 1, sizeof text - 1, f) : 0;
    text[n] = 0;
    if (f)
        fclose(f);
    return f ? text : "(none)";
}

static const struct option files_options[] = {
    {"from", "FILE", "what is read", OPTION_READS, .initial = NULL},
    {"to", "FILE", "what is written", OPTION_WRITES, .initial = NULL},
    {"also", "FILE", "what is written", OPTION_WRITES, .initial = NULL},
    {"into", "DIR", "where files go", OPTION_FOLDER, .initial = NULL},
    {.name = NULL}};
static const struct usage files_usage = {
    .name = "test", .words = "FILE", .max_words = 1, .words_read = 1, .table = {files_options}};

/* The status of a command line of up to three words; NULL ends it. */
static int parse(const char *a, const char *b, const char *c)
{
    const char *const word[] = {a, b, c};
    static char text[4][PATH + 64] = {"test"}; /* the guard keeps what the words say */
    char *argv[4] = {text[0]};
    struct options o;
    int n = 1, status;
    for (int i = 0; i < 3 && word[i]; i++, n++) {
        snprintf(text[n], sizeof text[n], "%s", word[i]);
        argv[n] = text[n];
    }
    (void)options_parse(&o, &files_usage, n, argv, &status);
    return status;
}

static const char *option(const char *name, const char *path)
{
    static char text[4][PATH + 64];
    static int i;
    i = (i + 1) % 4;
    snprintf(text[i], sizeof text[i], "--%s=%s", name, path);
    return text[i];
}

/* The tables of options say enough: the command calls nothing. */
TEST(files_tables)
{
    begin();
    put(at("a"), "a\n");
    check_int("a link", symlink("a", at("soft")), 0);
    check_int("another name", link(at("a"), at("hard")), 0);
    check_int("a link to what is not there", symlink("new", at("ahead")), 0);
    const char *const same[] = {"a", "./a", "soft", "hard"};
    for (int i = 0; i < 4; i++) {
        check_int("an option that is read", parse(option("from", at("a")), option("to", at(same[i])), NULL),
                  2);
        check_int("a word that is read", parse(at("a"), option("also", at(same[i])), NULL), 2);
        check_int("two outputs", parse(option("to", at("a")), option("also", at(same[i])), NULL), 2);
    }
    check_int("two that are not there", parse(option("to", at("new")), option("also", at("./new")), NULL), 2);
    check_int("one by a link", parse(option("to", at("new")), option("also", at("ahead")), NULL), 2);
    check_int("a file and a folder", parse(option("to", at("new")), option("into", at("new")), NULL), 2);
    check_int("files of their own", parse(at("a"), option("to", at("new")), option("also", at("b"))), 0);
    check_int("one device for all", parse(option("to", "/dev/null"), option("also", "/dev/null"), NULL), 0);
    check_int("no folder", parse(option("to", at("no/x")), NULL, NULL), 2);
    check_int("a folder is no file", parse(option("to", folder), NULL, NULL), 2);
    check_int("a file in a folder to be made",
              parse(option("into", at("no")), option("to", at("no/x")), NULL), 0);
    check_string("nothing was written", content(at("a")), "a\n");
    check_string("nor made", content(at("new")), "(none)");
    end();
}

/* A file that only the command knows, and files in a folder. */
TEST(files_inputs)
{
    char why[FILES_REASON];
    begin();
    put(at("scene"), "scene\n");
    check_int("the line", parse(option("to", at("scene")), NULL, NULL), 0);
    check_true("what is read is written", !files_reads(at("./scene"), "the scene itself", why));
    check_contains("and it is said", why, "is the scene itself; choose another");
    check_int("a folder", parse(option("into", folder), option("to", at("kept")), NULL), 0);
    check_true("an input", files_reads(at("scene"), "the scene itself", why));
    check_true("a file in the folder is the input", !files_take_in(folder, "scene", why));
    check_contains("and it is said", why, "is read by it");
    check_true("a file in the folder is an output", !files_take_in(folder, "kept", why));
    check_contains("and it is said", why, "kept, too");
    check_true("another file", files_take_in(folder, "image", why));
    check_true("an input is not opened", !files_create(at("scene")) && errno == ETXTBSY);
    check_true("nor composed", !files_compose(at("scene")));
    check_true("nor gone on with", !files_resume(at("scene")));
    check_string("it stays", content(at("scene")), "scene\n");
    end();
}

/* A device stays a device, a link a link, and what is not good is not written. */
TEST(files_write)
{
    struct stat s;
    begin();
    check_int("the line", parse(option("to", at("link")), NULL, NULL), 0);
    put(at("target"), "a longer text\n");
    check_int("a link", symlink("target", at("link")), 0);
    FILE *f = files_compose(at("link"));
    check_true("composed", f && fputs("short\n", f) >= 0);
    check_string("the file of before until the end", content(at("target")), "a longer text\n");
    check_true("it is complete", files_finish(f, true));
    check_string("all of it, and no more", content(at("target")), "short\n");
    check_true("the link is one", !lstat(at("link"), &s) && S_ISLNK(s.st_mode));
    f = files_compose(at("link"));
    check_true("what is not good", f && fputs("half", f) >= 0 && !files_finish(f, false));
    check_string("is not written", content(at("target")), "short\n");
    check_int("a pipe", mkfifo(at("pipe"), 0600), 0);
    check_int("the line", parse(option("to", at("pipe")), NULL, NULL), 0);
    FILE *reader = fopen(at("pipe"), "r+");
    f = files_compose(at("pipe"));
    char text[8] = "";
    check_true("into a pipe", f && fputs("piped\n", f) >= 0 && files_finish(f, true));
    check_string("comes through", reader ? fgets(text, sizeof text, reader) : "", "piped\n");
    check_true("which is one", !lstat(at("pipe"), &s) && S_ISFIFO(s.st_mode));
    if (reader)
        fclose(reader);
    check_int("the line", parse(option("to", "/dev/full"), NULL, NULL), 0);
    f = files_create("/dev/full");
    check_true("as it comes, without room",
               f && fputs("x", f) >= 0 && !files_finish(f, true) && errno == ENOSPC);
    f = files_create("/dev/full");
    static char block[65536];
    check_true("a block, which no buffer keeps", f && fwrite(block, 1, sizeof block, f) < sizeof block);
    errno = 0;
    check_true("  the reason is told when it ends", !files_finish(f, true) && errno == ENOSPC);
    f = files_compose("/dev/full");
    check_true("composed, without room",
               f && fputs("x", f) >= 0 && !files_finish(f, true) && errno == ENOSPC);
    end();
}
