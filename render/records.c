/* SPDX-License-Identifier: BSD-3-Clause */
/* Records in a hashed grid with cells of many sizes; blending; fitting. */
#include "render/records.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "math/sampling.h"

/* Off a record's plane light changes sooner than along it, and another surface begins. */
static const double PLANE_WORTH = 8;
/* A normal turned by this much (length of the difference) is as far away as the radius. */
static const double NORMAL_REACH = 0.35;

enum { LEVELS = 64 };

/* Of one group: as gathered, and fitted as in Record. */
typedef struct {
    Rgb    light;
    double fit[3][3];
} Apart;

/* A record in a cell: in one piece what throws most of them out. */
typedef struct {
    float    point[3];
    float    reach; /* square; more than that it is not, with all rounding */
    uint32_t record;
} Entry;

struct Records {
    Record  *record;
    size_t   capacity;
    uint32_t count;
    uint32_t groups;     /* 0: none are told apart */
    Apart   *apart;      /* [count * groups] */
    size_t   apart_capacity;
    /* Cells of level k are 2^(k - LEVELS/2) wide, at least twice the radius of the records there:
     * each lies in at most 8 of them. Cells of all levels share the buckets: a stranger in one is
     * told by its distance. */
    uint8_t   used[LEVELS], used_count;
    uint32_t  mask;      /* buckets - 1 */
    uint32_t *first;     /* [buckets + 1] */
    Entry    *entry;     /* [first[buckets]] */
};

Records *records_create(Error *err)
{
    return error_is_set(err) ? NULL : array_create(1, sizeof(Records), "records", err);
}

Records *records_destroy(Records *records)
{
    if (records == NULL)
        return NULL;
    array_free(records->record);
    array_free(records->apart);
    array_free(records->first);
    array_free(records->entry);
    return array_free(records);
}

uint32_t records_count(const Records *records) { return records->count; }

void records_split(Records *records, uint32_t groups)
{
    assert(records->count == 0 && groups <= RECORDS_GROUPS_MOST);
    records->groups = groups;
}

uint32_t records_groups(const Records *records) { return records->groups; }

/* --- the grid -------------------------------------------------------------------------------- */

static int level_of(double radius)
{
    assert(radius > 0);
    int exponent;
    (void)frexp(2 * radius, &exponent);
    const int level = exponent + LEVELS / 2;
    return level < 0 ? 0 : level >= LEVELS ? LEVELS - 1 : level;
}

/* How far it is of use. */
static double reach_of(const Record *record) { return record->radius * record->stretch; }

static double cells_per_unit(int level) { return ldexp(1, LEVELS / 2 - level); }

/* The cell number along one axis, wrapped: strangers may share a number, neighbours do not. */
static uint32_t cell_number(double x, double scale)
{
    const double cell = floor(x * scale);
    return (uint32_t)(int64_t)fmin(fmax(cell, -0x1p62), 0x1p62);
}

static uint32_t bucket_of(const Records *r, int level, uint32_t x, uint32_t y, uint32_t z)
{
    const uint32_t h = x * 0x9e3779b1U ^ y * 0x85ebca77U ^ z * 0xc2b2ae3dU ^
                       (uint32_t)level * 0x27d4eb2fU;
    return sampling_mix(h) & r->mask;
}

/* The buckets of the cells that a record's ball touches, without repeats; returns how many. */
static int buckets_of(const Records *r, const Record *record, uint32_t bucket[8])
{
    const double radius = reach_of(record);
    const int    level = level_of(radius);
    const double scale = cells_per_unit(level);
    const Vec3   p = record->at.point;
    uint32_t     lo[3] = { cell_number(p.x - radius, scale), cell_number(p.y - radius, scale),
                           cell_number(p.z - radius, scale) };
    uint32_t     hi[3] = { cell_number(p.x + radius, scale), cell_number(p.y + radius, scale),
                           cell_number(p.z + radius, scale) };
    int n = 0;
    for (int k = 0; k < 8; k++) {
        const uint32_t b = bucket_of(r, level, k & 1 ? hi[0] : lo[0], k & 2 ? hi[1] : lo[1],
                                     k & 4 ? hi[2] : lo[2]);
        bool known = false;
        for (int i = 0; i < n; i++)
            known = known || bucket[i] == b;
        if (!known)
            bucket[n++] = b;
    }
    return n;
}

/* Coordinates in float are off by 2^-24 of themselves, so are those of a point that is looked for:
 * a difference by less than twice that of both, and what its length is by less than thrice. */
static const double FLOAT_SLACK = 8 * 0x1p-24;

static Entry entry_of(const Records *r, uint32_t index)
{
    const Record *record = &r->record[index];
    const Vec3    p = record->at.point;
    const double  most = fmax(fmax(fabs(p.x), fabs(p.y)), fabs(p.z));
    const double  reach = reach_of(record);
    const double  slack = FLOAT_SLACK * (most + reach);
    return (Entry){ { (float)p.x, (float)p.y, (float)p.z },
                    (float)((reach + slack) * (reach + slack) * (1 + FLOAT_SLACK)), index };
}

/* Sorts all records into buckets once more. */
static bool fill_grid(Records *r, Error *err)
{
    uint32_t buckets = 64;
    while (buckets < 4 * (uint64_t)r->count && buckets < 1U << 30)
        buckets *= 2;
    r->mask = buckets - 1;
    array_free(r->first);
    array_free(r->entry);
    r->entry = NULL;
    r->first = array_create((size_t)buckets + 2, sizeof *r->first, "records", err);
    if (r->first == NULL)
        return false;
    uint32_t bucket[8];
    bool     used[LEVELS] = { false };
    for (uint32_t i = 0; i < r->count; i++) {
        used[level_of(reach_of(&r->record[i]))] = true;
        for (int k = buckets_of(r, &r->record[i], bucket); k-- > 0;)
            r->first[bucket[k] + 2]++;
    }
    for (uint32_t b = 2; b <= buckets + 1; b++)
        r->first[b] += r->first[b - 1];
    r->used_count = 0;
    for (uint8_t level = 0; level < LEVELS; level++)
        if (used[level])
            r->used[r->used_count++] = level;
    r->entry = array_create(r->first[buckets + 1], sizeof *r->entry, "records", err);
    if (r->entry == NULL)
        return false;
    for (uint32_t i = 0; i < r->count; i++) {
        const Entry entry = entry_of(r, i);
        for (int k = buckets_of(r, &r->record[i], bucket); k-- > 0;)
            r->entry[r->first[bucket[k] + 1]++] = entry;
    }
    return true;
}

static void make_level(Record *record)
{
    assert(record->stretch >= 1);
    record->across = vec3_cross(record->at.normal, record->along);
    memset(record->fit, 0, sizeof record->fit);
    record->fit[0][0] = record->irradiance.r;
    record->fit[1][0] = record->irradiance.g;
    record->fit[2][0] = record->irradiance.b;
    record->fitted_deviation = record->deviation;
}

static void make_level_apart(Apart *apart)
{
    memset(apart->fit, 0, sizeof apart->fit);
    apart->fit[0][0] = apart->light.r;
    apart->fit[1][0] = apart->light.g;
    apart->fit[2][0] = apart->light.b;
}

/* The groups of `count` records that come next. */
static bool add_apart(Records *r, const Rgb *light, uint32_t count, Error *err)
{
    void        *array = r->apart;
    const size_t before = (size_t)r->count * r->groups, more = (size_t)count * r->groups;
    if (!array_reserve(&array, &r->apart_capacity, before + more, sizeof *r->apart, "records",
                       err))
        return false;
    r->apart = array;
    for (size_t i = 0; i < more; i++) {
        r->apart[before + i].light = light[i];
        make_level_apart(&r->apart[before + i]);
    }
    return true;
}

bool records_add(Records *r, const Record *record, uint32_t count, Error *err)
{
    return records_add_apart(r, record, NULL, count, err);
}

bool records_add_apart(Records *r, const Record *record, const Rgb *light, uint32_t count,
                       Error *err)
{
    void  *array = r->record;
    assert(count == 0 || record != NULL);
    assert(count == 0 || (light != NULL) == (r->groups > 0));
    if (count == 0)
        return true;
    if (count > UINT32_MAX / 16 - r->count)
        return error_set(err, ERROR_MEMORY, "too many records of light");
    if (!array_reserve(&array, &r->capacity, (size_t)r->count + count, sizeof *record, "records",
                       err))
        return false;
    r->record = array;
    if (light != NULL && !add_apart(r, light, count, err))
        return false;
    memcpy(r->record + r->count, record, count * sizeof *record);
    for (uint32_t i = r->count; i < r->count + count; i++)
        make_level(&r->record[i]);
    r->count += count;
    return fill_grid(r, err);
}

/* --- reading --------------------------------------------------------------------------------- */

/* fmax without a call for what becomes of NaN. */
static inline double larger(double a, double b) { return a > b ? a : b; }

/* 1 at the record, falling to 0 where its ellipse ends. */
static double nearness_of(const Record *record, const Receiver *at)
{
    const Vec3   d = vec3_sub(at->point, record->at.point);
    const double rr = record->radius * record->radius, square = vec3_dot(d, d);
    if (!(square < rr * record->stretch * record->stretch))
        return 0;
    const double along = vec3_dot(d, record->along);
    const double dd = square - along * along * (1 - 1 / (record->stretch * record->stretch));
    const double off = PLANE_WORTH * larger(fabs(vec3_dot(d, record->at.normal)),
                                            fabs(vec3_dot(d, at->normal)));
    const double turn = 2 - 2 * vec3_dot(at->normal, record->at.normal); /* |n - n'|^2 */
    const double tt = (dd + off * off) / rr + turn / (NORMAL_REACH * NORMAL_REACH);
    return tt < 1 ? 1 - sqrt(larger(tt, 0)) : 0;
}

typedef void (*Visit)(void *context, uint32_t record, double nearness);

static inline void visit(const Records *r, const Receiver *at, Visit call, void *context)
{
    const float p[3] = { (float)at->point.x, (float)at->point.y, (float)at->point.z };
    for (uint32_t i = 0; i < r->used_count; i++) {
        const int      level = r->used[i];
        const double   scale = cells_per_unit(level);
        const uint32_t b = bucket_of(r, level, cell_number(at->point.x, scale),
                                     cell_number(at->point.y, scale),
                                     cell_number(at->point.z, scale));
        for (uint32_t k = r->first[b]; k < r->first[b + 1]; k++) {
            const Entry *e = &r->entry[k];
            const float  d[3] = { p[0] - e->point[0], p[1] - e->point[1], p[2] - e->point[2] };
            if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] > e->reach)
                continue;
            const double nearness = nearness_of(&r->record[e->record], at);
            if (nearness > 0)
                call(context, e->record, nearness);
        }
    }
}

static void find_basis(const Record *record, Vec3 point, double basis[3])
{
    const Vec3   d = vec3_sub(point, record->at.point);
    const double s = vec3_dot(d, record->along) / (record->radius * record->stretch);
    const double t = vec3_dot(d, record->across) / record->radius;
    const double value[3] = { 1, s, t };
    memcpy(basis, value, sizeof value);
}

typedef struct {
    const Records  *records;
    const Receiver *at;
    Rgb    sum;
    double weight, variance, nearness;
} Reading;

static void read_record(void *context, uint32_t index, double nearness)
{
    Reading      *reading = context;
    const Record *record = &reading->records->record[index];
    /* Without a kink where the radius ends; small radii know better. */
    const double  weight = nearness * nearness / record->radius;
    double        basis[3], e[3] = { 0 };
    find_basis(record, reading->at->point, basis);
    for (int band = 0; band < 3; band++)
        for (int k = 0; k < 3; k++)
            e[band] += record->fit[band][k] * basis[k];
    const Rgb     v = { larger(e[0], 0), larger(e[1], 0), larger(e[2], 0) };
    reading->sum = rgb_mad(reading->sum, weight, v);
    reading->weight += weight;
    reading->variance += weight * weight * record->fitted_deviation *
                         record->fitted_deviation;
    reading->nearness = larger(reading->nearness, nearness);
}

/* The same of all groups, into sums. */
typedef struct {
    const Records  *records;
    const Receiver *at;
    double weight;
    Rgb    sum[RECORDS_GROUPS_MOST];
} ReadingApart;

static void read_apart(void *context, uint32_t index, double nearness)
{
    ReadingApart  *reading = context;
    const Records *records = reading->records;
    const Record  *record = &records->record[index];
    const double   weight = nearness * nearness / record->radius; /* as above */
    const Apart   *apart = records->apart + (size_t)index * records->groups;
    double         basis[3];
    find_basis(record, reading->at->point, basis);
    for (uint32_t g = 0; g < records->groups; g++) {
        double e[3] = { 0 };
        for (int band = 0; band < 3; band++)
            for (int k = 0; k < 3; k++)
                e[band] += apart[g].fit[band][k] * basis[k];
        reading->sum[g] = rgb_mad(reading->sum[g], weight, rgb(e[0], e[1], e[2]));
    }
    reading->weight += weight;
}

Rgb records_find_apart(const Records *records, const Receiver *at, Rgb *sum)
{
    ReadingApart reading = { .records = records, .at = at };
    Rgb          all = { 0, 0, 0 };
    visit(records, at, read_apart, &reading);
    for (uint32_t g = 0; reading.weight > 0 && g < records->groups; g++) {
        const Rgb light = rgb_scale(reading.sum[g], 1 / reading.weight);
        sum[g] = rgb_add(sum[g], light);
        all = rgb_add(all, light);
    }
    return all;
}

bool records_find(const Records *records, const Receiver *at, Recorded *out)
{
    Reading reading = { .records = records, .at = at };
    visit(records, at, read_record, &reading);
    if (!(reading.weight > 0))
        return false;
    *out = (Recorded){ .irradiance = rgb_scale(reading.sum, 1 / reading.weight),
                       .deviation = sqrt(reading.variance) / reading.weight,
                       .nearness = reading.nearness };
    return true;
}

/* --- fitting --------------------------------------------------------------------------------- */

/* What keeps a fit of few or crowded neighbours from swinging: squares of slopes count as so much
 * of the neighbours' weight. Neighbours a quarter of the radius away, in the mean, outweigh it
 * twelve times. */
static const double stiffness[3] = { 0, 0.005, 0.005 };

/* Normal equations of the planes through the neighbours' values. */
typedef struct {
    const Records *records;
    const Record  *record;
    double weight;
    double matrix[3][3], right[3][3];
    double solved[3]; /* first row of the inverse */
    double variance;
    Apart *apart;     /* [groups]  of the record */
} Fit;

/* What a neighbour stands for: where records lie close, each speaks for little of the surface. */
static double share_of(const Record *other, const Record *record)
{
    const double area = other->radius * reach_of(other), own = record->radius * reach_of(record);
    return area < own ? area / own : 1;
}

static void fit_record(void *context, uint32_t index, double nearness)
{
    Fit          *fit = context;
    const Record *other = &fit->records->record[index];
    double        basis[3];
    nearness *= share_of(other, fit->record);
    find_basis(fit->record, other->at.point, basis);
    fit->weight += nearness;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            fit->matrix[i][k] += nearness * basis[i] * basis[k];
        fit->right[i][0] += nearness * basis[i] * other->irradiance.r;
        fit->right[i][1] += nearness * basis[i] * other->irradiance.g;
        fit->right[i][2] += nearness * basis[i] * other->irradiance.b;
    }
}

/* The right sides of all groups, where their planes will stand. */
static void fit_apart(void *context, uint32_t index, double nearness)
{
    const Fit     *fit = context;
    const Records *records = fit->records;
    const Apart   *other = records->apart + (size_t)index * records->groups;
    Apart         *own = fit->apart;
    double         basis[3];
    nearness *= share_of(&records->record[index], fit->record);
    find_basis(fit->record, records->record[index].at.point, basis);
    for (uint32_t g = 0; g < records->groups; g++) {
        const double light[3] = { other[g].light.r, other[g].light.g, other[g].light.b };
        for (int band = 0; band < 3; band++)
            for (int i = 0; i < 3; i++)
                own[g].fit[band][i] += nearness * basis[i] * light[band];
    }
}

/* The noise of the fitted value: each neighbour's, by its share in it. */
static void fit_noise(void *context, uint32_t index, double nearness)
{
    Fit          *fit = context;
    const Record *other = &fit->records->record[index];
    double        basis[3], share = 0;
    nearness *= share_of(other, fit->record);
    find_basis(fit->record, other->at.point, basis);
    for (int i = 0; i < 3; i++)
        share += fit->solved[i] * nearness * basis[i];
    fit->variance += share * share * other->deviation * other->deviation;
}

/* Cholesky's factor of the matrix, in its lower half; false: not positive. */
static bool factorise(double m[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k <= i; k++) {
            double sum = m[i][k];
            for (int j = 0; j < k; j++)
                sum -= m[i][j] * m[k][j];
            if (i == k && !(sum > 0))
                return false;
            m[i][k] = i == k ? sqrt(sum) : sum / m[k][k];
        }
    return true;
}

static void substitute(double (*const m)[3], double x[3])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < i; j++)
            x[i] -= m[i][j] * x[j];
        x[i] /= m[i][i];
    }
    for (int i = 2; i >= 0; i--) {
        for (int j = i + 1; j < 3; j++)
            x[i] -= m[j][i] * x[j];
        x[i] /= m[i][i];
    }
}

static void fit_one(const Records *records, Record *record)
{
    Fit fit = { .records = records, .record = record };
    visit(records, &record->at, fit_record, &fit);
    for (int i = 0; i < 3; i++)
        fit.matrix[i][i] += stiffness[i] * fit.weight;
    if (!factorise(fit.matrix))
        return;
    for (int band = 0; band < 3; band++) {
        double x[3];
        for (int i = 0; i < 3; i++)
            x[i] = fit.right[i][band];
        substitute(fit.matrix, x);
        memcpy(record->fit[band], x, sizeof x);
    }
    fit.apart = records->apart + (size_t)(record - records->record) * records->groups;
    for (uint32_t g = 0; g < records->groups; g++)
        memset(fit.apart[g].fit, 0, sizeof fit.apart[g].fit);
    if (records->groups > 0)
        visit(records, &record->at, fit_apart, &fit);
    for (uint32_t g = 0; g < records->groups; g++)
        for (int band = 0; band < 3; band++)
            substitute(fit.matrix, fit.apart[g].fit[band]);
    fit.solved[0] = 1;
    substitute(fit.matrix, fit.solved);
    visit(records, &record->at, fit_noise, &fit);
    record->fitted_deviation = sqrt(fit.variance);
}

void records_fit(Records *records, uint32_t begin, uint32_t end)
{
    assert(begin <= end && end <= records->count);
    for (uint32_t i = begin; i < end; i++)
        fit_one(records, &records->record[i]);
}
