/* SPDX-License-Identifier: BSD-3-Clause */
/* T-junctions stitched while connecting, and vertices of very many triangles. */
#include "tests/repair_case.h"

static void rectangle(Polygons *soup, double x0, double y0, double x1, double y1)
{
    soup_polygon(soup, (Vec3[]){ { x0, y0, 0 }, { x1, y0, 0 }, { x1, y1, 0 }, { x0, y1, 0 } }, 4,
                 0, 0);
}

static bool has_neighbour(const Surfaces *s, uint32_t i, uint32_t neighbour)
{
    const uint32_t *n = s->surface[i].neighbour;
    return n[0] == neighbour || n[1] == neighbour || n[2] == neighbour || n[3] == neighbour;
}

static void test_one_junction(void **state)
{
    (void)state;
    /* Two squares below a wide rectangle; the wide one stays a quad with a stitch at its middle. */
    for (int keep = 0; keep < 2; keep++) {
        Case c = { .options = { .keep_junctions = keep != 0 } };
        soup_start(&c.soup);
        rectangle(&c.soup, 0, 0, 4, 1);
        rectangle(&c.soup, 0, -1, 1, 0);
        rectangle(&c.soup, 1, -1, 4, 0);
        case_run(&c);
        assert_int_equal(c.s->count, 3);
        assert_int_equal(c.s->repairs.stitched, !keep);
        assert_int_equal(c.defects.found[DEFECT_T_JUNCTION], 1);
        assert_int_equal(c.defects.repaired[DEFECT_T_JUNCTION], !keep);
        const Defect *d = &c.defects.item[0];
        assert_int_equal(d->kind, DEFECT_T_JUNCTION);
        assert_int_equal(d->face, 0);
        assert_int_equal(d->other, 1);
        assert_true(d->at.x == 1 && d->at.y == 0);
        assert_int_equal(c.s->part_count, keep ? 2 : 1);
        if (keep) {
            assert_null(c.s->stitch_first);
            for (int k = 0; k < 4; k++)
                assert_int_equal(c.s->surface[0].neighbour[k], SURFACE_NONE);
        } else {
            unsigned edge = 0;
            while (c.s->stitch_first[edge + 1] == 0)
                edge++;
            assert_true(edge < 4);
            assert_int_equal(c.s->stitch_first[12], 1);
            assert_true(c.s->stitch[0].fraction == 0.25);
            assert_true(c.s->position[c.s->stitch[0].vertex].x == 1);
            assert_int_equal(c.s->surface[0].neighbour[edge], 1);
            assert_int_equal(c.s->stitch[0].neighbour, 2);
            assert_true(has_neighbour(c.s, 1, 0) && has_neighbour(c.s, 2, 0));
        }
        case_clear(&c);
    }
}

/* Rows of bricks, every other one shifted by half a brick: no edge is whole on both sides. */
static void test_bricks(void **state)
{
    (void)state;
    enum { ROWS = 5, COLUMNS = 7 };
    Case c = { 0 };
    soup_start(&c.soup);
    for (int j = 0; j < ROWS; j++)
        for (int i = 0; i < COLUMNS; i++)
            rectangle(&c.soup, i + 0.5 * (j % 2), j, i + 1 + 0.5 * (j % 2), j + 1);
    case_run(&c);
    assert_int_equal(c.s->count, ROWS * COLUMNS);
    assert_int_equal(c.s->part_count, 1);
    /* Between two rows there are 2 COLUMNS + 1 pieces, the first and the last not shared: 2 COLUMNS
     * - 1 shared ones, so 2 COLUMNS ends, each inside an edge of one of the rows. */
    assert_int_equal(c.s->repairs.stitched, (ROWS - 1) * 2 * COLUMNS);
    uint32_t links = 0;
    for (uint32_t i = 0; i < c.s->count; i++)
        for (int k = 0; k < 4; k++)
            links += c.s->surface[i].neighbour[k] != SURFACE_NONE;
    for (uint32_t i = 0; i < c.s->repairs.stitched; i++)
        links += c.s->stitch[i].neighbour != SURFACE_NONE;
    assert_int_equal(links, 2 * ((ROWS - 1) * (2 * COLUMNS - 1) + ROWS * (COLUMNS - 1)));
    case_clear(&c);
}

static void test_touching_is_no_junction(void **state)
{
    (void)state;
    /* A floor of two halves with a box's corners on the seam, one on its rim; a sheet that touches
     * the rim with a corner. */
    Case c = { 0 };
    soup_start(&c.soup);
    rectangle(&c.soup, 0, 0, 4, 2);
    rectangle(&c.soup, 0, 2, 4, 4);
    soup_box(&c.soup, vec3(1, 2, 0), vec3(2, 3, 1), 0, 0);
    soup_box(&c.soup, vec3(3, 0, 0), vec3(3.5, 0.5, 1), 0, 0);
    soup_polygon(&c.soup, (Vec3[]){ { 1.5, 4, 0 }, { 2, 5, 1 }, { 1, 5, 1 } }, 3, 0, 0);
    case_run(&c);
    assert_int_equal(c.s->repairs.stitched, 0);
    assert_null(c.s->stitch_first);
    assert_int_equal(c.s->part_count, 4);
    assert_int_equal(c.defects.count, 0);
    case_clear(&c);
}

static void test_junction_reach(void **state)
{
    (void)state;
    /* The middle corner off the long edge, in float half-ulps of the largest coordinate 8. */
    static const struct {
        double   off, weld;
        uint32_t stitched;
    } cases[] = { { 6, 0, 1 }, { 12, 0, 0 }, { 12, 1e-4, 1 }, { -6, 0, 1 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double y = cases[i].off * 8 * 0x1p-24;
        Case c = { .options = { .weld = cases[i].weld } };
        soup_start(&c.soup);
        rectangle(&c.soup, 0, 0, 8, 1);
        soup_polygon(&c.soup, (Vec3[]){ { 0, 0, 0 }, { 0, -1, 0 }, { 3, y, 0 } }, 3, 0, 0);
        soup_polygon(&c.soup, (Vec3[]){ { 3, y, 0 }, { 5, -1, 0 }, { 8, 0, 0 } }, 3, 0, 0);
        case_run(&c);
        assert_int_equal(c.s->repairs.stitched, cases[i].stitched);
        assert_int_equal(c.s->part_count, cases[i].stitched ? 1 : 3);
        case_clear(&c);
    }
}

/* A fan of 20,000 triangles along one long edge, in any order: not quadratic, all in one part. */
static void test_long_edge(void **state)
{
    (void)state;
    enum { N = 20000 };
    Case c = { 0 };
    soup_start(&c.soup);
    rectangle(&c.soup, 0, 0, N, 100);
    for (uint32_t i = 0; i < N; i++) {
        const double x = i * 7919u % N;
        soup_polygon(&c.soup, (Vec3[]){ { x, 0, 0 }, { N / 2, -100, 0 }, { x + 1, 0, 0 } }, 3, 0,
                     0);
    }
    case_run(&c);
    assert_int_equal(c.s->repairs.stitched, N - 1);
    assert_int_equal(c.s->part_count, 1);
    case_clear(&c);
}

/* 200,000 triangles round one vertex: a closed double cone. */
static void test_many_round_a_vertex(void **state)
{
    (void)state;
    enum { N = 100000 };
    Case c = { 0 };
    soup_start(&c.soup);
    Error err = { 0 };
    uint32_t rim[N], tip[2], index;
    for (uint32_t i = 0; i < N; i++) {
        const double a = 2 * M_PI * i / N;
        assert_true(polygons_add_vertex(&c.soup, vec3(cos(a), sin(a), 0), &rim[i], &err));
    }
    for (int k = 0; k < 2; k++)
        assert_true(polygons_add_vertex(&c.soup, vec3(0, 0, 1 - 2 * k), &tip[k], &err));
    assert_true(polygons_add_group(&c.soup, "cone", &index, &err));
    for (uint32_t i = 0; i < 2 * N; i++) {
        const uint32_t a = rim[i / 2], b = rim[(i / 2 + 1) % N];
        const uint32_t corner[3] = { tip[i % 2], i % 2 ? b : a, i % 2 ? a : b };
        assert_true(polygons_add_polygon(&c.soup, corner, 3, 0, index, &err));
    }
    case_run(&c);
    assert_int_equal(c.s->count, 2 * N);
    assert_int_equal(c.s->part_count, 1);
    assert_true(c.s->closed);
    assert_int_equal(c.s->repairs.refused, 0);
    case_clear(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_junction),
        cmocka_unit_test(test_bricks),
        cmocka_unit_test(test_touching_is_no_junction),
        cmocka_unit_test(test_junction_reach),
        cmocka_unit_test(test_long_edge),
        cmocka_unit_test(test_many_round_a_vertex),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
