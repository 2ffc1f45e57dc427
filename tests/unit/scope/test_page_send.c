/* test_page_send.c - which command of a plant is at work: the latest one. */
#include "host_sim/scope/page_send.h"
#include "tests/unit/test.h"

/* The connection of an earlier command may end after a later one has begun. */
TEST(page_send_end_of_an_earlier_command)
{
    static struct page_send c = {.n_plants = 1};
    const char *why;
    bool over;
    char text[100];
    c.plant[0].words = -1;
    uint32_t first = page_send_begin(&c, 0, "start", 5, &why),
             later = page_send_begin(&c, 0, "stop", 4, &why);
    check_is("the later one's number", later, ==, first + 1);
    page_send_leave(&c, 0, first);
    check_true("nobody listens to the first: the later one still comes to work", c.plant[0].waits);
    check_string("it is the later one", c.plant[0].line, "stop");
    text[page_send_read(&c, 0, first, text, sizeof text - 1, &over)] = '\0';
    check_string("the first one hears", text, "ended by a later command\n");
    check_true("that it is over", over);
    page_send_leave(&c, 0, later);
    check_true("nobody listens to the later one: it does not begin", !c.plant[0].waits);
}
