/* roff.c - see roff.h. */
#include "host_sim/help/roff.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { WIDTH = 78, BLOCK = 16384 };

/* A paragraph, a cell or a heading on its way out. */
struct flow {
    char text[BLOCK]; /* lines joined by blanks */
    size_t n;
    bool first;  /* no paragraph macro: a heading or a mark of a list stands before */
    bool fenced; /* inside of ``` */
    bool coded;  /* inside of lines of code */
};

/* One character as it is to be seen. */
static int put_character(char c)
{
    switch (c) {
    case '\\':
        return (int)fwrite("\\e", 1, 2, stdout);
    case '-':
        return (int)fwrite("\\-", 1, 2, stdout);
    case '^':
        return (int)fwrite("\\(ha", 1, 4, stdout);
    case '~':
        return (int)fwrite("\\(ti", 1, 4, stdout);
    case '`':
        return (int)fwrite("\\(ga", 1, 4, stdout);
    case '\'':
        return (int)fwrite("\\(aq", 1, 4, stdout);
    case '"':
        return (int)fwrite("\\(dq", 1, 4, stdout);
    default:
        putchar(c);
        return 1;
    }
}

static void put_plain(const char *text)
{
    if (*text == '.')
        fputs("\\&", stdout);
    while (*text)
        (void)put_character(*text++);
}

/* The end of a link's target, `](..)`, where one begins here; else the same place. */
static const char *behind_target(const char *at)
{
    const char *end = at[0] == ']' && at[1] == '(' ? strchr(at, ')') : NULL;
    return end ? end + 1 : at;
}

/* Where an emphasis by one star begins or ends: between a blank and a letter. */
static bool is_star(const char *text, const char *at, bool open)
{
    char before = at == text ? ' ' : at[-1];
    return *at == '*' && (open ? !isspace((unsigned char)before)
                               : isspace((unsigned char)before) && isalpha((unsigned char)at[1]));
}

/* Marks of Markdown become fonts, links their texts; lines break between words. */
static void put_marked(const char *text)
{
    bool code = false, bold = false, slanted = false;
    int column = 0;
    for (const char *at = text; *at;) {
        const char *next = code ? at : behind_target(at);
        if (next != at) {
            at = next;
        } else if (*at == '`') {
            code = !code;
            fputs(code ? "\\fB" : "\\fR", stdout);
            at++;
        } else if (!code && !strncmp(at, "**", 2)) {
            bold = !bold;
            fputs(bold ? "\\fB" : "\\fR", stdout);
            at += 2;
        } else if (!code && is_star(text, at, slanted)) {
            slanted = !slanted;
            fputs(slanted ? "\\fI" : "\\fR", stdout);
            at++;
        } else if (!code && (*at == '[' || (*at == '!' && at[1] == '['))) {
            at++;
        } else if (*at == ' ' && column > 0 && column + (int)strcspn(at + 1, " ") > WIDTH) {
            putchar('\n');
            column = 0;
            at++;
        } else {
            if (!column && *at == '.')
                fputs("\\&", stdout);
            column += put_character(*at++);
        }
    }
    putchar('\n');
}

/* The paragraph that was collected. */
static void end_block(struct flow *f)
{
    if (!f->n)
        return;
    if (!f->first)
        printf(".PP\n");
    f->text[f->n] = '\0';
    put_marked(f->text);
    f->first = false;
    f->n = 0;
}

static void add(struct flow *f, const char *text)
{
    text += strspn(text, " ");
    int n = snprintf(f->text + f->n, sizeof f->text - f->n, "%s%s", f->n ? " " : "", text);
    f->n += (size_t)n < sizeof f->text - f->n ? (size_t)n : 0;
}

static void end_code(struct flow *f)
{
    if (f->coded)
        printf(".fi\n.RE\n");
    f->coded = false;
}

static void put_code(struct flow *f, const char *line)
{
    end_block(f);
    if (!f->coded)
        printf("%s.RS 4\n.nf\n", f->first ? "" : ".PP\n");
    f->coded = true;
    f->first = false;
    put_plain(line);
    putchar('\n');
}

static void put_heading(struct flow *f, const char *line)
{
    size_t level = strspn(line, "#");
    end_block(f);
    printf(level < 3 ? ".SH " : ".SS ");
    put_marked(line + level + strspn(line + level, " "));
    f->first = true;
}

static void add_cell(struct flow *f, const char *cell)
{
    if (f->n)
        add(f, "|");
    add(f, cell);
}

/* A row: the first cell as a mark, the others behind it. */
static void put_row(struct flow *f, char *line)
{
    end_block(f);
    line += strspn(line, "| ");
    if (strspn(line, "-| :") == strlen(line))
        return;
    char *rest = strstr(line, " |");
    if (rest)
        *rest = '\0';
    printf(".TP\n");
    put_marked(line);
    for (char *cell = rest ? rest + 2 : NULL; cell; cell = rest ? rest + 2 : NULL) {
        rest = strstr(cell, " |");
        if (rest)
            *rest = '\0';
        if (cell[strspn(cell, " ")])
            add_cell(f, cell);
    }
    f->first = true;
    end_block(f);
    f->first = false;
}

static bool put_item(struct flow *f, const char *line)
{
    size_t digits = strspn(line, "0123456789");
    bool bullet = !strncmp(line, "- ", 2),
         number = digits > 0 && digits < 3 && !strncmp(line + digits, ". ", 2);
    if (!bullet && !number)
        return false;
    end_block(f);
    if (bullet)
        printf(".IP \\(bu 2\n");
    else
        printf(".IP %.*s. 4\n", (int)digits, line);
    f->first = true;
    add(f, line + digits + 2);
    return true;
}

/* `blank`: the line before was one. */
static void put_line(struct flow *f, char *line, bool blank)
{
    if (!strncmp(line, "```", 3)) {
        end_block(f);
        end_code(f);
        f->fenced = !f->fenced;
        return;
    }
    if (f->fenced || (!strncmp(line, "    ", 4) && !f->n && (blank || f->coded))) {
        put_code(f, f->fenced ? line : line + 4);
        return;
    }
    if (*line)
        end_code(f);
    if (!*line)
        end_block(f);
    else if (*line == '#')
        put_heading(f, line);
    else if (*line == '|')
        put_row(f, line);
    else if (!put_item(f, line))
        add(f, line);
}

void roff_print(const char *name, const char *version, const char *text)
{
    static struct flow f;
    char line[4096], before[4096] = "";
    f = (struct flow){.first = true};
    const char *title = text + strspn(text, "# ");
    printf(".TH ");
    put_plain(name);
    printf(" 7 \"\" \"contactplant %s\" contactplant\n.SH NAME\n", version);
    put_plain(name);
    snprintf(line, sizeof line, "%.*s", (int)strcspn(title, "\n"), title);
    printf(" \\- ");
    put_marked(line);
    printf(".SH DESCRIPTION\n");
    for (text += strcspn(text, "\n"); *text; text += strcspn(text, "\n")) {
        text++;
        snprintf(line, sizeof line, "%.*s", (int)strcspn(text, "\n"), text);
        put_line(&f, line, !*before);
        snprintf(before, sizeof before, "%.4000s", line);
    }
    end_block(&f);
    end_code(&f);
}
