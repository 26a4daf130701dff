/* bench_tables.c - prints docs/format-tables.md: the tables of numbers that docs/format.md refers to. */
#include <stdio.h>

/* For the tables that no header shows. */
#include "common/codec/lh04/codec_lh04_model.c"

#include "common/codec/mask/void_mask.h"

/* Numbers in lines of at most 110 columns. */
static int column;

static void put(int value)
{
    char text[16];
    int size = snprintf(text, sizeof text, "%s%d", column ? " " : "    ", value);
    if (column + size > 110) {
        column = 0;
        putchar('\n');
        size = snprintf(text, sizeof text, "    %d", value);
    }
    fputs(text, stdout);
    column += size;
}

static void end(void)
{
    putchar('\n');
    column = 0;
}

static void put_detail_model(int set)
{
    static const char *const band[TC_BANDS] = {"HL", "LH", "HH"};
    tc_detail_model m;
    tc_detail_model_builtin(set, &m);
    printf("\n## Details, built-in set %d\n\nPrediction: HL, LH.\n\n", set);
    for (int b = 0; b < 2; b++, end())
        for (int k = 0; k < (b == TC_HL ? TC_PREDICT_KERNEL : TC_PREDICT); k++)
            put(m.predict[b][k]);
    for (int b = 0; b < TC_BANDS; b++) {
        printf("\nScale weights of %s: phase 0, 1.\n\n", band[b]);
        for (int p = 0; p < TC_PHASES; p++, end())
            for (int k = 0; k < TC_SCALE; k++)
                put(m.scale[b][p][k]);
    }
    printf("\nSymbol frequencies of bins 0 ... 23.\n\n");
    for (int b = 0; b < TC_BINS; b++, end())
        for (int s = 0; s < TC_RANS_SYMBOLS; s++)
            put(m.symbols[b].of[s]);
}

static void put_lh04_model(void)
{
    printf("\n## Residuals of LH04, built-in\n\nCodes of weights: class 0 ... 3, phase 0, 1.\n\n");
    for (int c = 0; c < TC_LH04_CLASSES; c++)
        for (int p = 0; p < TC_PHASES; p++, end())
            for (int n = 0; n < TC_LH04_SCALE; n++)
                put(builtin_weight[c][p][n]);
    printf("\nSymbol frequencies of bins 0 ... 23.\n\n");
    for (int b = 0; b < TC_BINS; b++, end())
        for (int s = 0; s < TC_RANS_SYMBOLS; s++)
            put(builtin_symbols[b][s]);
}

static void put_mask_model(int kind)
{
    const tc_mask_model *m = &tc_mask_models[kind];
    printf("\n## Void masks, samples of kind %d\n\nNear samples: dx dy, the first gives the most significant bit.\n\n",
           kind);
    for (int i = 0; i < TC_MASK_NEAR; i++)
        put(m->near[i].x), put(m->near[i].y);
    end();
    printf("\nFurther samples: dx dy score, one a line.\n\n");
    for (int i = 0; i < m->far_count; i++, end())
        put(m->far[i].x), put(m->far[i].y), put(m->far[i].score);
    printf("\nScores 0 ... 255.\n\n");
    for (int n = 0; n < 1 << TC_MASK_NEAR; n++)
        put(m->score[n]);
    end();
}

int main(void)
{
    printf("# Tables of the packed terrain\n\n"
           "Numbers that [format.md](format.md) refers to, printed by `tests/bench/bench_tables.c`.\n");
    for (int set = 0; set < TC_BUILTIN_MODELS; set++)
        put_detail_model(set);
    put_lh04_model();
    for (int kind = 0; kind < 3; kind++)
        put_mask_model(kind);
    return 0;
}
