/* SPDX-License-Identifier: BSD-3-Clause */
/* A solved mesh in the window. */
#include "app/live_solved.h"

#include <assert.h>
#include <time.h>

#include "app/solved_shown.h"

bool live_solved_allowed(const Options *options, Error *err)
{
    static const OptionId fit[] = {
        OPTION_THREADS, OPTION_PROGRESS, OPTION_SIZE, OPTION_EXPOSURE, OPTION_TONE, OPTION_CAMERA,
        OPTION_EYE, OPTION_TARGET, OPTION_UP, OPTION_FOV, OPTION_SCRIPT, OPTION_SCREENSHOT,
        OPTION_FRAMES, OPTION_RATE, OPTION_NO_PANELS
    };
    for (int id = 0; id < OPTION_COUNT; id++) {
        bool fits = !options_given(options, (OptionId)id);
        for (size_t k = 0; k < sizeof fit / sizeof *fit; k++)
            fits = fits || fit[k] == (OptionId)id;
        if (!fits)
            return error_set(err, ERROR_USAGE, "%s: %s is solved already", options_table()[id].name,
                             options->scene);
    }
    return true;
}

static void report(const LiveSolved *live, uint32_t patches, double seconds)
{
    const Report r = { .doing = "solved", .done = 1, .unshot = -1, .residual = -1, .left = -1,
                       .seconds = seconds, .memory = progress_peak_bytes(), .patches = patches };
    control_report(live->control, &r);
}

static bool show_file(const LiveSolved *live, Error *err)
{
    Options *options = &live->session->options;
    const double begin = progress_now();
    SolvedMesh solved = { 0 };
    Snapshot *snapshot = NULL;
    if (solved_mesh_read(&solved, options->scene, err))
        snapshot = solved_shown(&solved, options, err);
    if (snapshot != NULL) {
        options->unit_m = solved.notes.unit_m > 0 ? solved.notes.unit_m : 1;
        options->units = solved.notes.watts ? UNITS_RADIOMETRIC : UNITS_PHOTOMETRIC;
        report(live, snapshot->mesh->patch_count, progress_now() - begin);
        mailbox_put(live->mailbox, snapshot);
    }
    solved_mesh_clear(&solved);
    return snapshot != NULL;
}

static void *run(void *user)
{
    static const struct timespec A_MOMENT = { .tv_nsec = 10 * 1000 * 1000 };
    const LiveSolved *live = user;
    Control *control = live->control;
    while (!atomic_load(&control->quit) && !session_stopped(live->session)) {
        EaselWish wish;
        if (easel_take(&control->easel, &wish))
            easel_fail(&control->easel, wish.number,
                       "a solved mesh has no materials to gather with");
        if (atomic_load(&control->restart)) {
            Error err = { 0 };
            atomic_store(&control->finished, false);
            if (!show_file(live, &err))
                control_say(control, err.text);
            atomic_store(&control->restart, false);
            atomic_store(&control->knobs.settled, atomic_load(&control->knobs.version));
            atomic_store(&control->finished, true);
        }
        nanosleep(&A_MOMENT, NULL);
    }
    atomic_store(&control->failed, true);
    return NULL;
}

bool live_solved_start(LiveSolved *live, Session *session, Mailbox *mailbox, Control *control,
                       Error *err)
{
    *live = (LiveSolved){ .session = session, .mailbox = mailbox, .control = control };
    if (!show_file(live, err))
        return false;
    atomic_store(&control->finished, true);
    atomic_store(&control->knobs.settled, atomic_load(&control->knobs.version));
    if (pthread_create(&live->thread, NULL, run, live) != 0)
        return error_set(err, ERROR_FAILED, "no thread to read the file again");
    return true;
}

void live_solved_join(LiveSolved *live) { pthread_join(live->thread, NULL); }
