/* SPDX-License-Identifier: BSD-3-Clause */
/* Faces cut where others touch them: as a step of the pipeline, and as a part of the check. */
#include <assert.h>

#include "app/pipeline.h"

/* Pieces that faces are cut into where others touch them, however few patches are asked for: few
 * patches are no reason to leave faces uncut. */
enum { PIECES_LEAST = 60000 };

/* What is switched off was found all the same. */
static void leave_found(Defects *defects, const ImprintOptions *options)
{
    if (options->keep_whole)
        defects_leave(defects, DEFECT_CUT);
    if (options->keep_covered) {
        defects_leave(defects, DEFECT_COVERED);
        defects_leave(defects, DEFECT_COVERED_PART);
    }
}

bool pipeline_imprint(Pipeline *pipeline, bool tell, Imprint *imprint, Error *err)
{
    const Session *session = pipeline->session;
    const ImprintOptions *asked = &session->settings.imprint;
    const bool check = session->options.command == COMMAND_CHECK;
    const uint32_t patches = session->settings.patches;
    ImprintOptions options = *asked;
    Monitor monitor = session->monitor;
    assert(pipeline->scene != NULL && imprint != NULL);
    options.most = patches > PIECES_LEAST ? patches : PIECES_LEAST;
    if (check)
        options = (ImprintOptions){ .most = options.most, .defects = &pipeline->defects };
    else if (asked->keep_whole && asked->keep_covered)
        return false;
    if (!tell || check)
        monitor.warn = NULL;
    if (!imprint_create(&pipeline->scene->polygons, &options, imprint, &monitor, err))
        return false;
    pipeline->cuts = (CutCount){ .cut = imprint->cut, .covered = imprint->covered,
                                 .left = imprint->left, .area = imprint->covered_area };
    imprint->soup.origin = imprint->face;
    if (!check)
        return true;
    leave_found(&pipeline->defects, asked);
    imprint_clear(imprint);
    return false;
}
