/* SPDX-License-Identifier: BSD-3-Clause */
/* Half-edges of polygons: who is across, what is refused. */
#include "mesh/halfedge.h"
#include "tests/soup_tools.h"

/* A rectangle with corners in the middle of edges, triangles at one of them, a quad beside it:
 *   5---4---3
 *   |   A   |      A: 0 1 2 3 4 5
 *   0---1---2      B: 1 0 6   C: 2 1 6   D: 3 2 7 8 */
static void test_polygons(void **state)
{
    (void)state;
    const uint32_t first[] = { 0, 6, 9, 12, 16 };
    const uint32_t corner[] = { 0, 1, 2, 3, 4, 5, 1, 0, 6, 2, 1, 6, 3, 2, 7, 8 };
    uint8_t refused[4];
    Error err = { 0 };
    HalfEdges *mesh = halfedge_create(first, corner, 4, 9, refused, &err);
    assert_non_null(mesh);
    uint32_t across[16];
    for (uint32_t i = 0; i < 16; i++)
        across[i] = HALFEDGE_NONE;
    across[0] = 6;   /* 0 1 and 1 0 */
    across[6] = 0;
    across[1] = 9;   /* 1 2 and 2 1 */
    across[9] = 1;
    across[2] = 12;  /* 2 3 and 3 2 */
    across[12] = 2;
    across[8] = 10;  /* 6 1 and 1 6 */
    across[10] = 8;
    for (uint32_t i = 0; i < 16; i++)
        assert_int_equal(halfedge_across(mesh, i), across[i]);
    for (int i = 0; i < 4; i++)
        assert_int_equal(refused[i], 0);
    halfedge_destroy(mesh);
}

/* A third triangle at an edge is kept apart, with its numbers. */
static void test_refused(void **state)
{
    (void)state;
    const uint32_t corner[] = { 0, 1, 2, 1, 0, 3, 0, 1, 4, 4, 1, 5 };
    uint8_t refused[4];
    Error err = { 0 };
    HalfEdges *mesh = halfedge_create(NULL, corner, 4, 6, refused, &err);
    assert_non_null(mesh);
    static const uint8_t expected[4] = { 0, 0, 1, 0 };
    for (int i = 0; i < 4; i++)
        assert_int_equal(refused[i], expected[i]);
    assert_int_equal(halfedge_across(mesh, 0), 3);
    assert_int_equal(halfedge_across(mesh, 3), 0);
    for (uint32_t i = 6; i < 12; i++)
        assert_int_equal(halfedge_across(mesh, i), HALFEDGE_NONE);
    halfedge_destroy(mesh);
    mesh = halfedge_create(NULL, NULL, 0, 0, NULL, &err);
    assert_non_null(mesh);
    halfedge_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_polygons),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
