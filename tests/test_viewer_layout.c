/* SPDX-License-Identifier: BSD-3-Clause */
/* Panels in windows of many sizes: all of them in sight, those that matter open. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

#include "viewer/layout.h"

static const LayoutSize large = { 1024, 768, 19, 290, 250 };

static void set_all(LaidPanel panel[PANEL_COUNT], bool change)
{
    static const double need[PANEL_COUNT] = { 235, 215, 240, 120, 230 };
    for (int k = 0; k < PANEL_COUNT; k++)
        panel[k] = (LaidPanel){ .there = true, .need = need[k] };
    panel[change ? PANEL_MEASURE : PANEL_CHANGE].there = false;
}

static void room_for_all(void **state)
{
    (void)state;
    LaidPanel p[PANEL_COUNT];
    set_all(p, false);
    layout_panels(&large, p);
    for (int k = 0; k < PANEL_COUNT; k++)
        assert_false(p[k].fold);
    /* One below the other, 6 pixels between, from 8 on; the other column ends 8 before the rim. */
    const double y[] = { 8, 8 + 235 + 6, 8 + 235 + 6 + 215 + 6, 8 };
    for (int k = 0; k <= PANEL_MEASURE; k++)
        assert_true(fabs(p[k].y - y[k]) < 1e-9 && p[k].room >= p[k].need);
    assert_true(fabs(p[PANEL_MEASURE].x - (1024 - 8 - 250)) < 1e-9);
}

/* Height of a panel as it will be drawn. */
static double drawn(const LaidPanel *p, const LayoutSize *size)
{
    return p->fold ? size->title : fmin(p->need, p->room);
}

static void always_in_sight(void **state)
{
    (void)state;
    static const int sizes[][2] = { { 640, 480 }, { 640, 300 }, { 320, 240 }, { 200, 1000 },
                                    { 1600, 130 }, { 300, 160 } };
    for (unsigned s = 0; s < sizeof sizes / sizeof *sizes; s++)
        for (int change = 0; change < 2; change++) {
            LayoutSize size = large;
            LaidPanel p[PANEL_COUNT];
            size.width = sizes[s][0];
            size.height = sizes[s][1];
            set_all(p, change == 1);
            layout_panels(&size, p);
            assert_false(p[PANEL_PATCH].fold);
            for (int k = 0; k < PANEL_COUNT; k++) {
                if (!p[k].there)
                    continue;
                assert_true(p[k].x >= 0 && p[k].x + p[k].width <= size.width);
                assert_true(p[k].y >= 0 && p[k].y + drawn(&p[k], &size) <= size.height);
                for (int j = 0; j < k; j++) /* none covers another */
                    assert_true(!p[j].there || p[j].x + p[j].width <= p[k].x ||
                                p[j].y + drawn(&p[j], &size) <= p[k].y);
            }
        }
}

/* 480 pixels have room for two of them and a title, 240 for one. */
static void folded_in_order(void **state)
{
    (void)state;
    LaidPanel p[PANEL_COUNT];
    LayoutSize size = large;
    size.width = 640;
    size.height = 540;
    set_all(p, false);
    layout_panels(&size, p);
    assert_true(p[PANEL_VIEW].fold && !p[PANEL_SOLVER].fold && !p[PANEL_MEASURE].fold);
    size.width = 320;
    size.height = 240;
    layout_panels(&size, p);
    assert_true(p[PANEL_VIEW].fold && p[PANEL_SOLVER].fold && p[PANEL_MEASURE].fold);
    p[PANEL_PATCH].there = false;
    p[PANEL_MEASURE].there = false;
    p[PANEL_CHANGE].there = true;
    layout_panels(&size, p);
    assert_true(p[PANEL_VIEW].fold && p[PANEL_SOLVER].fold && !p[PANEL_CHANGE].fold);
    /* 1 x 1: nothing fits, and nothing breaks. */
    size.width = size.height = 1;
    layout_panels(&size, p);
    assert_true(p[PANEL_CHANGE].room > 0 && p[PANEL_CHANGE].width > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(room_for_all),
        cmocka_unit_test(always_in_sight),
        cmocka_unit_test(folded_in_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
