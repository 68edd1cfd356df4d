/* SPDX-License-Identifier: BSD-3-Clause */
/* Checkpoints of a run. */
#include "app/saving.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/output.h"
#include "app/pipeline_adapt.h"
#include "base/array.h"
#include "base/file.h"

_Static_assert((int)ADAPT_PASSES <= (int)CHECKPOINT_PASSES, "all passes can be told");

/* The caller's parts of a checkpoint: the last is tiles of a picture once there is a solution, and
 * what solvers without links of patches have before. */
enum { PART_NOTE, PART_TILES, PART_LIGHT = PART_TILES };

/* What reports say, kept beside the data itself. */
typedef struct {
    uint32_t    state, passes;
    AdaptReport adapt;
    LinksReport raw, report;
    LinksChange change;
    double      factors_seconds, closure_seconds, rounding;
    uint32_t    view, unused; /* pictures that are finished and written */
    StochasticReport stochastic;
    ClustersReport   clusters;
} Note;

/* --- what the run is made from ---------------------------------------------------------------- */

static uint64_t hash_text(const Session *session, uint64_t key)
{
    char  *text = NULL;
    size_t size = 0;
    Settings settings = session->settings;
    settings.threads = 1; /* do not matter */
    FILE *stream = open_memstream(&text, &size);
    if (stream == NULL)
        return key;
    fprintf(stream, "isolux %s %s\n", ISOLUX_VERSION, command_name(session->options.command));
    quality_print(stream, &session->options, &settings);
    /* What is not among settings, of solvers without links. */
    fprintf(stream, "%d %d %d\n", options_given(&session->options, OPTION_TOLERANCE),
            session->options.importance, session->options.no_last_gather);
    fclose(stream);
    key = file_hash(text, size, key);
    free(text);
    return key;
}

static uint64_t hash_view(const Pipeline *p, const Camera *c, uint64_t key)
{
    const Options *options = &p->session->options;
    const double *crop = options->crop;
    const double view[] = { c->eye.x, c->eye.y, c->eye.z, c->target.x, c->target.y, c->target.z,
                            c->up.x, c->up.y, c->up.z, c->vertical_fov, c->projection,
                            c->view_height, c->aperture, c->focus, p->width, p->height,
                            crop[0], crop[1], crop[2], crop[3], options->pixel_filter,
                            options->diffuse };
    return file_hash(view, sizeof view, key);
}

/* Scene, options and what came of them up to the patches. */
static uint64_t find_key(const Pipeline *p)
{
    const Patches *patches = p->patches;
    uint64_t key = hash_text(p->session, p->scene->hash);
    for (uint32_t k = 0; k < p->view_count; k++)
        key = hash_view(p, &p->view[k], key);
    key = file_hash(patches->surface, patches->count * sizeof *patches->surface, key);
    key = file_hash(patches->side, patches->count, key);
    key = file_hash(patches->area, patches->count * sizeof *patches->area, key);
    if (p->point_count > 0) {
        key = file_hash(p->point, p->point_count * sizeof *p->point, key);
        key = file_hash(p->normal, p->point_count * sizeof *p->normal, key);
    }
    for (size_t i = 0; i < p->changes.count; i++) {
        const Change *change = &p->changes.change[i];
        const double values[] = { change->what, change->factor, change->kind, change->index,
                                  change->value.r, change->value.g, change->value.b };
        key = file_hash(values, sizeof values, key);
    }
    for (size_t i = 0; i < p->scene->polygons.material_count; i++) {
        const Material *m = &p->scene->polygons.materials[i];
        key = file_hash(&m->reflectance, sizeof m->reflectance, key);
        key = file_hash(&m->emission, sizeof m->emission, key);
    }
    return key;
}

/* --- saving ----------------------------------------------------------------------------------- */

/* The note, and light groups behind it where the solution is known.
 * owns   the caller frees the part. */
static bool add_note(const Saving *s, Checkpoint *c, Error *err)
{
    const Pipeline *p = s->pipeline;
    const bool grouped = s->state == SAVING_SOLUTION && p->relit.groups != NULL;
    void  *groups = NULL;
    size_t size = 0;
    if (grouped && !light_groups_pack(p->relit.groups, &groups, &size, err))
        return false;
    unsigned char *bytes = array_create(sizeof(Note) + size, 1, "a checkpoint", err);
    const Note note = (Note){ .state = s->state, .passes = p->adapt.passes, .adapt = p->adapt,
                    .raw = p->raw, .report = p->report, .change = p->change,
                    .factors_seconds = p->factors_seconds,
                    .closure_seconds = p->closure_seconds, .rounding = p->rounding,
                    .view = s->view, .stochastic = p->stochastic, .clusters = p->clusters };
    c->part[PART_NOTE] = bytes;
    c->size[PART_NOTE] = sizeof note + size;
    if (bytes != NULL) {
        memcpy(bytes, &note, sizeof note);
        if (size > 0)
            memcpy(bytes + sizeof note, groups, size);
    }
    array_free(groups);
    return bytes != NULL;
}

/* All of the links but the links: the solution needs no more. */
static bool bare_links(const Links *links, Links *bare, Error *err)
{
    *bare = (Links){ .count = links->count, .escape = links->escape, .area = links->area,
                     .lamp = links->lamp, .rays = links->rays, .clamped = links->clamped,
                     .seconds = links->seconds };
    bare->first = array_create((size_t)links->count + 1, sizeof *bare->first, "a checkpoint", err);
    return bare->first != NULL;
}

static bool save(Saving *s, Error *err)
{
    const Pipeline *p = s->pipeline;
    const bool under_way = s->rows != NULL && kept_rows_casting(s->rows);
    Checkpoint c = { .key = s->key, .passes = p->adapt.passes };
    Links bare = { 0 };
    if (s->state == SAVING_LINKS && under_way)
        c.passes = s->passes;
    memcpy(c.count, s->count, sizeof c.count);
    memcpy(c.split, s->split, sizeof c.split);
    c.rows = under_way ? s->rows : NULL;
    if (!add_note(s, &c, err))
        return false;
    if (s->state == SAVING_LINKS)
        c.links = p->links;
    if (s->state == SAVING_SOLUTION) {
        if (!bare_links(p->links, &bare, err) ||
            (s->tiles != NULL &&
             !kept_tiles_pack(s->tiles, &c.part[PART_TILES], &c.size[PART_TILES], err)))
            return array_free(bare.first) != NULL || array_free(c.part[PART_NOTE]) != NULL;
        c.links = &bare;
        c.solution = p->solution;
    }
    const bool light = s->state == SAVING_ROWS; /* lent, not made */
    if (light)
        c.part[PART_LIGHT] = p->session->settings.clusters
                                 ? clusters_kept_bytes(s->clusters, &c.size[PART_LIGHT])
                                 : stochastic_kept_bytes(s->light, &c.size[PART_LIGHT]);
    const bool saved = checkpoint_save(&c, s->path, err);
    array_free(c.part[PART_NOTE]);
    array_free(light ? NULL : c.part[PART_TILES]);
    array_free(bare.first);
    return saved;
}

void saving_now(Saving *s)
{
    if (s == NULL || s->path == NULL || s->state == SAVING_NOTHING ||
        s->pipeline->session->hurry || s->pipeline->session->broken)
        return;
    if (!save(s, &s->error))
        s->pipeline->session->broken = true;
    s->last = progress_now();
}

void saving_tick(Saving *s)
{
    /* What was saved at a stop is the last: what follows is rough. */
    if (s == NULL || s->path == NULL || s->stopped)
        return;
    const bool stop = session_stopped(s->pipeline->session);
    if (!stop && progress_now() - s->last < s->every)
        return;
    saving_now(s);
    s->stopped = stop;
}

static void tick(void *user)
{
    saving_tick(user);
}

/* --- going on --------------------------------------------------------------------------------- */

static bool refuse(const Saving *s, const char *why, Error *err)
{
    return error_at(err, ERROR_INPUT, s->pipeline->session->options.resume, 0, "%s", why);
}

static bool take_note(const Saving *s, Note *note, Error *err)
{
    const Checkpoint *c = &s->loaded;
    if (c->part[PART_NOTE] == NULL || c->size[PART_NOTE] < sizeof *note)
        return refuse(s, "is a checkpoint of another version", err);
    memcpy(note, c->part[PART_NOTE], sizeof *note);
    const bool pass = c->rows != NULL && note->state == SAVING_LINKS;
    if (note->state < SAVING_ROWS || note->state > SAVING_SOLUTION ||
        note->adapt.passes > ADAPT_PASSES || note->passes != note->adapt.passes ||
        c->passes != note->passes + pass || note->view > s->pipeline->view_count ||
        (note->state == SAVING_ROWS) != (c->links == NULL) ||
        (note->state == SAVING_SOLUTION) != (c->solution != NULL))
        return refuse(s, "is a checkpoint whose pieces do not fit together", err);
    return true;
}

/* Divides the patches as they were; the pass under way is left for pipeline_adapt. */
static bool take_passes(Saving *s, const Note *note, Error *err)
{
    Checkpoint *c = &s->loaded;
    Pipeline *p = s->pipeline;
    for (uint32_t k = 0; k < c->passes; k++) {
        if (c->count[k] != p->patches->count)
            return refuse(s, "divides other patches than there are", err);
        s->count[k] = c->count[k];
        s->split[k] = c->split[k];
        c->split[k] = NULL;
        s->passes = k + 1;
        s->chosen = k >= note->passes;
        if (!s->chosen && !pipeline_adapt_again(p, s->split[k], err))
            return false;
    }
    return true;
}

/* What a solver without links of patches has so far. */
static bool take_light(Saving *s)
{
    Checkpoint *c = &s->loaded;
    const uint32_t count = s->pipeline->patches->count;
    const size_t size = c->size[PART_LIGHT];
    void *bytes = c->part[PART_LIGHT];
    StochasticKept *light = saving_light(s);
    ClustersKept *clusters = saving_clusters(s);
    if (light == NULL && clusters == NULL)
        return false;
    c->part[PART_LIGHT] = NULL; /* theirs from now on */
    return clusters != NULL ? clusters_kept_load(clusters, bytes, size, count)
                            : stochastic_kept_load(light, bytes, size, count);
}

static bool take_links(Saving *s, const Note *note, Error *err)
{
    Checkpoint *c = &s->loaded;
    Pipeline *p = s->pipeline;
    const uint32_t count = p->patches->count;
    if ((c->links != NULL && c->links->count != count) ||
        (c->solution != NULL && (c->solution->count != count || c->solution->bands != ROOM_BANDS)))
        return refuse(s, "holds links of other patches than there are", err);
    p->links = c->links;
    p->solution = c->solution;
    c->links = NULL;
    c->solution = NULL;
    p->adapt = note->adapt;
    p->raw = note->raw;
    p->report = note->report;
    p->change = note->change;
    p->factors_seconds = note->factors_seconds;
    p->closure_seconds = note->closure_seconds;
    p->rounding = note->rounding;
    s->views_before = note->view;
    p->stochastic = note->stochastic;
    p->clusters = note->clusters;
    if (c->size[PART_NOTE] > sizeof *note) {
        const unsigned char *groups = (const unsigned char *)c->part[PART_NOTE] + sizeof *note;
        p->relit.groups = light_groups_unpack(groups, c->size[PART_NOTE] - sizeof *note, count,
                                              err);
        if (p->relit.groups == NULL)
            return refuse(s, "holds light groups that cannot be", err);
    }
    if (c->rows != NULL) {
        kept_rows_destroy(s->rows);
        s->rows = c->rows;
        c->rows = NULL;
    }
    if (note->state == SAVING_ROWS && c->part[PART_LIGHT] != NULL && !take_light(s))
        return refuse(s, "holds light that cannot be", err);
    if (c->part[PART_TILES] != NULL &&
        !kept_tiles_unpack(s->tiles, c->part[PART_TILES], c->size[PART_TILES]))
        return refuse(s, "holds a picture that cannot be", err);
    return true;
}

bool saving_resume(Saving *s, Error *err)
{
    Note note = { .state = SAVING_ROWS };
    if (s == NULL)
        return true;
    s->key = find_key(s->pipeline);
    s->state = SAVING_ROWS;
    if (!s->resuming)
        return true;
    s->resuming = false;
    if (s->loaded.key != s->key)
        return refuse(s, "was made from another scene or with other options", err);
    const bool good = take_note(s, &note, err) && take_passes(s, &note, err) &&
                      take_links(s, &note, err);
    checkpoint_clear(&s->loaded);
    s->state = note.state;
    return good;
}

/* --- pieces ----------------------------------------------------------------------------------- */

void saving_state(Saving *s, SavingState state)
{
    if (s == NULL)
        return;
    /* Of a solution that was broken off, what was saved before is worth more. */
    const Pipeline *p = s->pipeline;
    const bool broken = state == SAVING_SOLUTION && p->solution != NULL &&
                        !p->solution->converged && session_stopped(p->session);
    s->state = broken ? SAVING_NOTHING : state;
}

KeptRows *saving_rows(Saving *s)
{
    return s != NULL ? s->rows : NULL;
}

StochasticKept *saving_light(Saving *s)
{
    const Settings *settings = s != NULL ? &s->pipeline->session->settings : NULL;
    return s != NULL && settings->stochastic && !settings->clusters ? s->light : NULL;
}

ClustersKept *saving_clusters(Saving *s)
{
    return s != NULL && s->pipeline->session->settings.clusters ? s->clusters : NULL;
}

void saving_view(Saving *s, uint32_t view)
{
    if (s != NULL)
        s->view = view;
}

uint32_t saving_views_before(const Saving *s)
{
    return s != NULL ? s->views_before : 0;
}

KeptTiles *saving_tiles(Saving *s)
{
    /* Tiles that were loaded are of the first picture that was not finished. */
    return s != NULL && !s->pipeline->session->hurry && s->view >= s->views_before ? s->tiles
                                                                                   : NULL;
}

bool saving_pass(Saving *s, const uint8_t *split, Error *err)
{
    if (s == NULL)
        return true;
    const uint32_t k = s->pipeline->adapt.passes, count = s->pipeline->patches->count;
    assert(k < CHECKPOINT_PASSES);
    array_free(s->split[k]);
    s->split[k] = array_create(count, 1, "patches to divide", err);
    if (s->split[k] == NULL)
        return false;
    memcpy(s->split[k], split, count);
    s->count[k] = count;
    s->passes = k + 1;
    return true;
}

const uint8_t *saving_chosen(Saving *s)
{
    if (s == NULL || !s->chosen)
        return NULL;
    s->chosen = false;
    return s->split[s->passes - 1];
}

/* --- beginning and end ------------------------------------------------------------------------ */

/* room.ply.checkpoint beside room.ply; without -o named after the scene, here. */
static bool name_file(Saving *s, const Options *options, Error *err)
{
    const bool named = options->output != NULL && strcmp(options->output, "-") != 0;
    const char *base = named ? options->output
                       : options->scene != NULL ? output_base(options->scene) : "isolux";
    if (options->resume != NULL)
        snprintf(s->name, sizeof s->name, "%s", options->resume);
    else if ((size_t)snprintf(s->name, sizeof s->name, "%s.checkpoint", base) >= sizeof s->name)
        return error_set(err, ERROR_USAGE, "the file name '%.100s...' is too long", base);
    s->path = s->name;
    return output_probe(s->path, options, err);
}

bool saving_begin(Saving *s, Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    const Options *options = &session->options;
    *s = (Saving){ .pipeline = pipeline, .every = options->checkpoint, .last = progress_now() };
    if (error_is_set(err))
        return false;
    if (options->resume != NULL) {
        if (!checkpoint_load(&s->loaded, options->resume, err))
            return false;
        s->resuming = true;
    }
    if (options_given(options, OPTION_CHECKPOINT) && !name_file(s, options, err))
        return false;
    if (s->path == NULL && !s->resuming)
        return true;
    pipeline->saving = s;
    session->tick = tick;
    session->tick_user = s;
    s->rows = kept_rows_create(err);
    s->tiles = kept_tiles_create(err);
    s->light = stochastic_kept_create(err);
    s->clusters = clusters_kept_create(err);
    return !error_is_set(err);
}

void saving_end(Saving *s, bool finished)
{
    if (finished && s->path != NULL)
        unlink(s->path);
    s->pipeline->session->tick = NULL;
    s->pipeline->saving = NULL;
    checkpoint_clear(&s->loaded);
    for (uint32_t k = 0; k < CHECKPOINT_PASSES; k++)
        array_free(s->split[k]);
    kept_rows_destroy(s->rows);
    kept_tiles_destroy(s->tiles);
    stochastic_kept_destroy(s->light);
    clusters_kept_destroy(s->clusters);
}
