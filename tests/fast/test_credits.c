/* test_credits.c - what strangers' files say of whose they are becomes short lines without control characters. */
#include "tests/support/test.h"

#include "common/app/credits.h"

#include <stdio.h>
#include <string.h>

static void lines_are_clean(void **state)
{
    (void)state;
    static const struct {
        const char *text, *line;
    } cases[] = {
        {"(c) A. Person", "(c) A. Person"},
        {"  two\r\n lines\t\x1b[31m ", "two lines [31m"},
        {"\xc2\xa9 2024 \xe5\x9c\xb0\xe5\x9b\xb3", "\xc2\xa9 2024 \xe5\x9c\xb0\xe5\x9b\xb3"}, /* UTF-8 */
        {"\xa9 Universit\xe4t", "\xc2\xa9 Universit\xc3\xa4t"},                               /* Latin-1 */
        {"a\xe2\x80\xae"
         "b\xc2\x9b"
         "c",
         "a b c"}, /* turned around; an escape of one byte more */
        {"a\u061cb\u180ec\u115f\u1160\u3164d\uffa0\u3000e", "a b c d e"}, /* turned around; blank letters */
        {"x\xc0\xaf\xed\xa0\x80\xf5y\xe5\x9c", "x\xc3\x80\xc2\xaf\xc3\xad \xc3\xb5y\xc3\xa5"}, /* no UTF-8 */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        tc_credits credits = {.count = 0};
        tc_credits_add(&credits, cases[i].text);
        assert_true(credits.count == 1);
        assert_string_equal(credits.line[0], cases[i].line);
    }
}

static void what_is_empty_is_none(void **state)
{
    (void)state;
    tc_credits credits = {.count = 0};
    tc_credits_add(&credits, "");
    tc_credits_add(&credits, " \n\x01\x7f\xe2\x80\x8b");
    tc_credits_add(&credits, "\u3164\uffa0\u2800");
    assert_true(credits.count == 0);
}

static void lines_are_short(void **state)
{
    (void)state;
    char text[4096];
    for (int shift = 0; shift < 3; shift++) {
        tc_credits credits = {.count = 0};
        memset(text, 'a', (size_t)shift);
        for (size_t i = (size_t)shift; i + 3 < sizeof text; i += 3)
            memcpy(text + i, "\xe5\x9c\xb0", 4);
        tc_credits_add(&credits, text);
        const size_t length = strlen(credits.line[0]);
        assert_true(credits.count == 1 && length < TC_CREDIT_LENGTH && length > TC_CREDIT_LENGTH - 16);
        assert_true((length - 4 - (size_t)shift) % 3 == 0);
        assert_string_equal(credits.line[0] + length - 4, " ...");
    }
}

static void few_are_kept(void **state)
{
    (void)state;
    tc_credits credits = {.count = 0};
    char text[32];
    for (int i = 0; i < 3 * TC_CREDITS; i++) {
        snprintf(text, sizeof text, "person %d", i / 2);
        tc_credits_add(&credits, text);
    }
    assert_true(credits.count == TC_CREDITS);
    assert_string_equal(credits.line[1], "person 1");
    assert_string_equal(credits.line[TC_CREDITS - 1], "... and others");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_are_clean),
        cmocka_unit_test(what_is_empty_is_none),
        cmocka_unit_test(lines_are_short),
        cmocka_unit_test(few_are_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
