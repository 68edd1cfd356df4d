/* SPDX-License-Identifier: BSD-3-Clause */
/* Grey-body exchange: one dense system, by Gaussian elimination. */
#include "radiosity/exchange.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"

static bool problem_is_good(const ExchangeProblem *p, Error *err)
{
    for (size_t i = 0; i < p->count; i++) {
        if (!(p->emissivity[i] > 0 && p->emissivity[i] <= 1))
            return error_set(err, ERROR_INPUT, "emissivity %g of surface %zu is not in 0..1",
                             p->emissivity[i], i + 1);
        for (size_t j = 0; j < p->count; j++)
            if (!(p->factor[i * p->count + j] >= 0 && isfinite(p->factor[i * p->count + j])))
                return error_set(err, ERROR_INPUT, "form factor from %zu to %zu is %g", i + 1,
                                 j + 1, p->factor[i * p->count + j]);
    }
    return true;
}

/* I - diag of reflectance on the columns of F: K_ij = delta_ij - F_ij (1 - eps_j). Row sums of F
 * are at most 1, so K is dominated by its diagonal: no pivots are needed [higham02]. */
static void fill_matrix(const ExchangeProblem *p, double *k)
{
    const size_t n = p->count;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            k[i * n + j] = (i == j) - p->factor[i * n + j] * (1 - p->emissivity[j]);
}

/* Solves K x = b for `columns` right sides in place; K is destroyed. */
static bool eliminate(double *k, double *b, size_t n, size_t columns, Error *err)
{
    for (size_t i = 0; i < n; i++) {
        const double pivot = k[i * n + i];
        if (!(pivot > 0))
            return error_set(err, ERROR_INPUT, "surface %zu sends itself all it reflects: no "
                             "balance exists", i + 1);
        for (size_t r = i + 1; r < n; r++) {
            const double m = k[r * n + i] / pivot;
            if (m == 0)
                continue;
            for (size_t c = i + 1; c < n; c++)
                k[r * n + c] -= m * k[i * n + c];
            for (size_t c = 0; c < columns; c++)
                b[r * columns + c] -= m * b[i * columns + c];
        }
    }
    for (size_t i = n; i-- > 0;)
        for (size_t c = 0; c < columns; c++) {
            double x = b[i * columns + c];
            for (size_t j = i + 1; j < n; j++)
                x -= k[i * n + j] * b[j * columns + c];
            b[i * columns + c] = x / k[i * n + i];
        }
    return true;
}

bool exchange_factors(const ExchangeProblem *p, double *gebhart, double *hottel, Error *err)
{
    assert(p != NULL && p->factor != NULL && p->emissivity != NULL && err != NULL);
    const size_t n = p->count;
    if (error_is_set(err) || !problem_is_good(p, err))
        return false;
    double *k = array_create(n * n, sizeof *k, "exchange factors", err);
    double *g = array_create(n * n, sizeof *g, "exchange factors", err);
    if (k != NULL && g != NULL) {
        fill_matrix(p, k);
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; j < n; j++)
                g[i * n + j] = p->factor[i * n + j] * p->emissivity[j];
        eliminate(k, g, n, n, err);
    }
    if (!error_is_set(err)) {
        if (gebhart != NULL)
            memcpy(gebhart, g, n * n * sizeof *g);
        for (size_t i = 0; hottel != NULL && i < n; i++)
            for (size_t j = 0; j < n; j++)
                hottel[i * n + j] = p->emissivity[i] * g[i * n + j];
    }
    array_free(k);
    array_free(g);
    return !error_is_set(err);
}

bool exchange_flux(const ExchangeProblem *p, const double *temperature, double surroundings,
                   double *flux, Error *err)
{
    assert(p != NULL && temperature != NULL && flux != NULL && err != NULL);
    const size_t n = p->count;
    if (error_is_set(err) || !problem_is_good(p, err))
        return false;
    for (size_t i = 0; i < n; i++)
        if (!(temperature[i] >= 0 && isfinite(temperature[i])))
            return error_set(err, ERROR_INPUT, "temperature %g K of surface %zu is not 0 or more",
                             temperature[i], i + 1);
    double *k = array_create(n * n, sizeof *k, "heat exchange", err);
    if (k == NULL)
        return false;
    /* Irradiance H = F J + escape * outside and J = eps E + (1 - eps) H give
     * (I - F rho) H = F eps E + escape * outside. */
    const double outside = EXCHANGE_STEFAN_BOLTZMANN * pow(surroundings, 4);
    fill_matrix(p, k);
    for (size_t i = 0; i < n; i++) {
        flux[i] = p->escape != NULL ? p->escape[i] * outside : 0;
        for (size_t j = 0; j < n; j++)
            flux[i] += p->factor[i * n + j] * p->emissivity[j] * EXCHANGE_STEFAN_BOLTZMANN *
                       pow(temperature[j], 4);
    }
    eliminate(k, flux, n, 1, err);
    for (size_t i = 0; i < n; i++)
        flux[i] = p->emissivity[i] *
                  (flux[i] - EXCHANGE_STEFAN_BOLTZMANN * pow(temperature[i], 4));
    array_free(k);
    return !error_is_set(err);
}
