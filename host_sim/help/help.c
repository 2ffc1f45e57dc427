/* help.c - contactplant help: the pages beside the program, a search in them, and what to do when it goes
 * wrong. */
#include "host_sim/help/help.h"
#include "host_sim/cli/options.h"
#include "host_sim/cli/paragraph.h"
#include "host_sim/cli/trouble.h"
#include "host_sim/commands.h"
#include "host_sim/help/advice.h"
#include "host_sim/help/pages.h"
#include "host_sim/help/roff.h"
#include "host_sim/help/search.h"
#include "host_sim/version.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PAGER_MISSING = 127, WHY = 1024 };

/* The page with messages of the program, which --errors searches behind its own tables. */
#define ERRORS_PAGE "docs/guide/trouble.md"

static const struct option help_options[] = {
    {"search", NULL, "print each line of the pages that has all words, with its page and heading",
     OPTION_FLAG, .initial = NULL},
    {"errors", NULL,
     "print what to do about a fault, a refusal, a counter or a message; without a word about all",
     OPTION_FLAG, .initial = NULL},
    {.name = NULL},
};

static const struct usage help_usage = {
    .name = "help",
    .words = "[PAGE]",
    .summary = "Prints a page of the guides, the reference or the reasons, on a terminal by $PAGER. Without "
               "a word it\n"
               "prints the subcommands and the names of all pages.",
    .words_help = "PAGE is a name as of the list, or a path as other pages have it: docs/guide/fmi.md.\n"
                  "With --search words stand there, with --errors a name, a value of FAULTS,\n"
                  "or words of a message.\n",
    .examples = "  contactplant help embedding\n"
                "  contactplant help --search early return\n"
                "  contactplant help --errors stale\n",
    .max_words = OPTIONS_WORDS,
    .table = {help_options}};

/* ---- pages ---- */

/* The title of a page: its first heading. */
static void print_title(const struct pages *p, int i)
{
    char name[PAGES_NAME], *text = pages_read(p, i);
    const char *title = text ? text : "";
    pages_short(p, i, name);
    title += strspn(title, "# ");
    printf("  %-22s %.*s\n", name, (int)strcspn(title, "\n"), title);
    free(text);
}

static void list_pages(const struct pages *p)
{
    printf("pages (contactplant help PAGE):\n");
    for (int i = 0; i < p->n; i++)
        print_title(p, i);
}

/* True when a pager has shown it. */
static bool show_by_pager(const char *text)
{
    const char *pager = getenv("PAGER");
    setenv("LESS", "FRX", 0); /* a page that fits the screen ends the pager */
    FILE *f = popen(pager && *pager ? pager : "less", "w");
    if (!f)
        return false;
    void (*before)(int) = signal(SIGINT, SIG_IGN); /* Ctrl-C is the pager's */
    fputs(text, f);
    int status = pclose(f);
    signal(SIGINT, before);
    return !(WIFEXITED(status) && WEXITSTATUS(status) == PAGER_MISSING);
}

bool help_has_page(const char *word)
{
    static struct pages pages;
    char why[WHY];
    return pages_find(&pages, why, sizeof why) && pages_named(&pages, word) >= 0;
}

/* The text of the page of this name and its number; NULL, and *status after a line. */
static char *open_page(const struct usage *u, const struct pages *p, const char *word, int *i, int *status)
{
    *i = pages_named(p, word);
    if (*i < 0) {
        const char *nearest = pages_nearest(p, word);
        *status = options_misuse(u, "no page is called \"%s\"; %s%s%s", word,
                                 nearest ? "did you mean " : "contactplant help lists all",
                                 nearest ? nearest : "", nearest ? "?" : "");
        return NULL;
    }
    char *text = pages_read(p, *i);
    if (!text)
        *status = options_failure(u, "cannot read %s/%s: %s; install again", p->folder, p->name[*i],
                                  strerror(errno));
    return text;
}

static int print_page(const struct pages *p, const char *word)
{
    int i, status = STATUS_DONE;
    char *text = open_page(&help_usage, p, word, &i, &status);
    if (text && (!isatty(STDOUT_FILENO) || !show_by_pager(text)))
        fputs(text, stdout);
    free(text);
    return status;
}

int help_print_manual(const struct usage *u, const char *word)
{
    static struct pages pages;
    char why[WHY], name[2 * PAGES_NAME] = "contactplant-";
    int i, status = STATUS_DONE;
    if (!pages_find(&pages, why, sizeof why))
        return options_failure(u, "%s", why);
    char *text = open_page(u, &pages, word, &i, &status);
    if (text) {
        pages_short(&pages, i, name + strlen(name));
        roff_print(name, VERSION_TEXT, text);
    }
    free(text);
    return status;
}

/* The words of a command line as one text. */
static const char *words_of(const struct options *o, char *text, size_t size)
{
    size_t n = 0;
    text[0] = '\0';
    for (int i = 0; i < o->n_words && n < size; i++)
        n += (size_t)snprintf(text + n, size - n, "%s%s", i ? " " : "", o->word[i]);
    return text;
}

static int search(const struct pages *p, const struct options *o)
{
    char text[WHY];
    int found = 0;
    if (!o->n_words)
        return options_misuse(&help_usage, "--search wants words; give some");
    for (int i = 0; i < p->n; i++) {
        int n = search_page(p, i, o->word, o->n_words);
        found += n > 0 ? n : 0;
    }
    return found ? STATUS_DONE
                 : options_failure(&help_usage, "no line of the pages has \"%s\"; try fewer words",
                                   words_of(o, text, sizeof text));
}

/* ---- when it goes wrong ---- */

/* A name with its meanings in the plant's tables, and the advice. */
static void print_advice(const char *name)
{
    struct named n;
    printf("%s\n", name);
    for (enum advice_list list = 0; list < ADVICE_LISTS; list++)
        for (int i = 0; advice_named(list, i, &n); i++)
            if (!strcmp(n.name, name))
                paragraph_print(stdout, 2, "", "%s: %s", advice_list_name[list], n.meaning);
    paragraph_print(stdout, 2, "", "-> %s", advice_text(name));
}

static bool print_advice_on(const char *word)
{
    bool found = false;
    for (int i = 0; advice_name(i); i++)
        if (!strcasecmp(advice_name(i), word)) {
            print_advice(advice_name(i));
            found = true;
        }
    return found;
}

/* The bits of FAULTS: `40`, `0x28`, or with FAULTS= before them in a line of monitor. */
static bool print_faults_in(const char *text)
{
    static const char key[] = "FAULTS=";
    const char *at = strstr(text, key), *number = at ? at + strlen(key) : text;
    char *end;
    unsigned long faults = strtoul(number, &end, 0);
    bool told = *number >= '0' && *number <= '9' && (at || !*end) && faults && faults < 1u << TROUBLE_FAULTS;
    for (int i = 0; told && i < TROUBLE_FAULTS; i++)
        if (faults >> i & 1u)
            print_advice(trouble_fault[i].name);
    return told;
}

/* Messages that the page of errors has. */
static bool print_messages(const struct options *o, const char *text)
{
    static struct pages pages;
    char why[WHY];
    int page = pages_find(&pages, why, sizeof why) ? pages_named(&pages, ERRORS_PAGE) : -1;
    return page >= 0 && search_messages(&pages, page, text, o->word, o->n_words) > 0;
}

/* Names that stand in the text between others: `FIRE: late`. */
static bool print_names_in(const char *text)
{
    bool found = false;
    for (size_t n; *text; text += n ? n : 1) {
        char name[PAGES_NAME];
        n = strspn(text, "abcdefghijklmnopqrstuvwxyz_");
        snprintf(name, sizeof name, "%.*s", (int)n, text);
        found = (n > 0 && n < sizeof name && print_advice_on(name)) || found;
    }
    return found;
}

static int no_advice(const char *text)
{
    const char *name[NAMES_INDICES];
    int n = 0;
    for (; advice_name(n); n++)
        name[n] = advice_name(n);
    return options_misuse(
        &help_usage, "nothing is known about \"%s\"%s", text,
        options_advise(text, strlen(text), name, n, "contactplant help --errors prints all names"));
}

static int errors(const struct options *o)
{
    char text[WHY];
    words_of(o, text, sizeof text);
    if (!o->n_words) {
        for (int i = 0; advice_name(i); i++)
            print_advice(advice_name(i));
        return STATUS_DONE;
    }
    bool known =
        print_advice_on(text) || print_faults_in(text) || print_messages(o, text) || print_names_in(text);
    return known ? STATUS_DONE : no_advice(text);
}

int cmd_help(int argc, char **argv)
{
    static struct pages pages;
    struct options o;
    char why[WHY];
    int status;
    if (!options_parse(&o, &help_usage, argc, argv, &status))
        return status;
    bool searches = options_given(&o, "search"), explains = options_given(&o, "errors");
    for (int i = 0; i < o.n_words; i++)
        if (!*o.word[i])
            return options_misuse(&help_usage, "a word is empty; leave it out");
    if (searches && explains)
        return options_misuse(&help_usage, "--search and --errors are two questions; ask one");
    if (explains)
        return errors(&o);
    if (!searches && o.n_words > 1)
        return options_misuse(&help_usage,
                              "\"%s\" is one word too many; name one page, or --search for words", o.word[1]);
    if (!pages_find(&pages, why, sizeof why))
        return options_failure(&help_usage, "%s", why);
    if (searches)
        return search(&pages, &o);
    if (o.n_words)
        return print_page(&pages, o.word[0]);
    list_pages(&pages);
    return STATUS_DONE;
}
