/* credits.h - whose data are shown, in the words of their files: a few short lines. They come from strangers: no
 * control character is left, nor a sign that turns the direction of others; how letters look is not looked at, nor how
 * many marks stand over one. */
#ifndef TC_CREDITS_H
#define TC_CREDITS_H

enum { TC_CREDITS = 6, TC_CREDIT_LENGTH = 160 /* bytes, UTF-8, with its end */ };

typedef struct tc_credits {
    char line[TC_CREDITS][TC_CREDIT_LENGTH];
    int count;
} tc_credits;

/* Adds what a file says; not what is there already, nor what is empty. Where there is no room the last line tells of
 * others. Signs that control, and those known to be blank, become spaces, of which one is left where there are several;
 * bytes that are no UTF-8 are taken for Latin-1; what is too long is cut between characters, and ends in dots. */
void tc_credits_add(tc_credits *credits, const char *text);

/* The same of a source's callback: its context is the credits. */
void tc_credits_take(void *credits, const char *text);

/* All lines with newlines between them; empty where there is none. */
enum { TC_CREDITS_TEXT = TC_CREDITS * TC_CREDIT_LENGTH };
void tc_credits_join(const tc_credits *credits, char text[TC_CREDITS_TEXT]);

#endif
