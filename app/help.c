/* SPDX-License-Identifier: BSD-3-Clause */
/* Help for people: examples first, then the options of the command out of the one table. */
#include <assert.h>
#include <link.h>
#include <string.h>

#include "app/options.h"
#include "base/parallel.h"
#include "raycast/bvh.h"

typedef struct {
    Command     command;
    const char *arguments, *purpose, *examples, *notes;
} CommandHelp;

static const CommandHelp command_help[] = {
    { COMMAND_RENDER, "SCENE [-o FILE.exr]", "solve, then gather: an EXR of radiance and a PNG",
      "  isolux render room.glb -o room.exr        room.exr and room.png\n"
      "  isolux render room.msd --quality draft    a first look; room.exr here\n"
      "  isolux render room.obj --eye 1,1.6,4 --target 0,1,0 --size 1280x720\n"
      "  isolux render attic.obj --light ceiling   a scene that has no lamp\n"
      "  isolux render room.msd --false-colour illuminance --isolines\n"
      "  isolux render room.msd --projection panorama --size 1024x512\n",
      "The EXR holds radiance (cd/m2 or W/m2/sr) as R G B and layers: direct, indirect,\n"
      "albedo, irradiance, normal, depth, patch. The PNG beside it is exposed for the eye.\n" },
    { COMMAND_SOLVE, "SCENE [-o FILE.ply]", "solve; the mesh with its light as PLY",
      "  isolux solve room.glb -o room.ply         opens in MeshLab, ParaView, Blender\n"
      "  isolux solve room.msd --json -            only the numbers\n"
      "  isolux solve room.msd --patches 50000 --solver progressive -o room.ply\n"
      "  isolux solve room.msd --compare -o solvers.csv\n"
      "  isolux solve room.msd --set lamp.emission='*0.5' -o dim.ply\n",
      "Faces of the PLY are patches, with radiosity, irradiance, reflectance, area, surface,\n"
      "group and material; units are in its comment lines. Without -o only figures are made.\n" },
    { COMMAND_FACTORS, "SCENE [-o FILE.csv]", "form factors (view factors) by group or patch",
      "  isolux factors oven.obj -o F.csv          one row and column per group\n"
      "  isolux factors oven.obj --by material     to standard output\n"
      "  isolux factors oven.obj --by patch -o F   F.mtx (Matrix Market), F.csv (patches)\n"
      "  isolux factors oven.obj --closure none --rays 4096 -o F.csv\n"
      "  isolux factors oven.obj --points p.csv    what points see of each group\n",
      "A row holds F from its group to each column's; with `escaped` it sums to 1. In a scene\n"
      "without lamp and camera only front sides take part; --sides both adds the backs.\n" },
    { COMMAND_MEASURE, "SCENE --points FILE [-o FILE.csv]", "illuminance at points, CSV",
      "  isolux measure room.glb --points desk.csv -o lux.csv\n"
      "  echo 1,2,0.8,0,0,1 | isolux measure room.msd --points -\n",
      "Points are x,y,z,nx,ny,nz, a line each; # starts a comment and a heading line may come\n"
      "first. Out come the same columns, then E per band, their luminance (lux), the part of it\n"
      "that comes straight from lamps, and its standard error.\n" },
    { COMMAND_CHECK, "SCENE", "what is in the file, what is wrong, what was repaired",
      "  isolux check room.glb\n"
      "  isolux check room.glb --json report.json\n", NULL },
    { COMMAND_VALIDATE, "[--filter TEXT]", "cases with known answers",
      "  isolux validate\n"
      "  isolux validate --filter furnace\n"
      "  isolux validate --json -\n",
      "Each line: case, quantity, expected, value, deviation, verdict. Exit code 4 when one\n"
      "fails.\n" },
    { COMMAND_BENCH, "[SCENE]", "rays per second; seconds and memory per stage",
      "  isolux bench                              the built-in Cornell box\n"
      "  isolux bench room.glb --json bench.json\n", NULL },
    { COMMAND_VIEW, "SCENE|SOLUTION.ply", "a window: watch light spread, walk about, measure",
      "  isolux view room.glb\n"
      "  isolux view room.msd --patches 50000 --solver progressive\n"
      "  isolux view room.glb --script keys.txt --screenshot room.png\n"
      "  isolux view room.ply                      as solve -o room.ply wrote it\n"
      "  isolux view --list-bindings\n",
      "Light is shown from the first moment on and gets better. F1 shows keys and mouse.\n" },
    { COMMAND_COMPARE, "REFERENCE.exr PICTURE.exr", "how far one picture is from another",
      "  isolux compare reference.exr room.exr\n"
      "  isolux compare reference.exr room.exr --json -\n"
      "  isolux compare reference.exr room.exr -o difference.png\n",
      "Errors are root mean squares of the difference in luminance, relative to the reference's\n"
      "mean. Left out: lamps and two pixels around them, and black background. smooth: without\n"
      "silhouettes; block: smooth pixels in means of 8 x 8, so without pixel noise.\n" },
    { COMMAND_DEVELOP, "PICTURE.exr [-o FILE.png]", "a PNG of a picture's light, shown otherwise",
      "  isolux develop room.exr --exposure 1 --tone filmic -o room.png\n"
      "  isolux develop room.exr --false-colour illuminance --isolines\n"
      "  isolux develop room.exr --false-colour luminance --log --range 1,10000\n"
      "  isolux develop room.exr --mix lamp=0.5 --mix window=1,0.8,0.6\n",
      "Without -o: room.png, or room.illuminance.png for false colours, beside the picture.\n"
      "Values are labelled lux and cd/m2, with --units radiometric W/m2 and W/m2/sr.\n" },
};
enum { HELP_COUNT = sizeof command_help / sizeof *command_help };

static const char exit_codes[] =
    "Exit codes: 0 done; 1 failed; 2 wrong usage; 3 input unreadable or invalid; 4 result written\n"
    "but a stated tolerance was missed; 5 stopped by limit or signal, what there is was saved;\n"
    "6 out of memory or over --max-memory.\n";

void help_program(FILE *out)
{
    fputs("isolux computes how light settles in a room.\n\n"
          "  isolux render room.glb -o room.exr\n\n"
          "Commands (each has --help):\n", out);
    for (int i = 0; i < HELP_COUNT; i++)
        fprintf(out, "  %-10s%s\n", command_name(command_help[i].command),
                command_help[i].purpose);
    fprintf(out, "\nScenes: MSD, OBJ, glTF, GLB, PLY, STL, 3DS, COLLADA, FBX and more.\n"
                 "isolux --version tells the libraries and what this processor offers.\n%s",
            exit_codes);
}

static void print_option(FILE *out, const OptionRow *row)
{
    char left[64];
    enum { COLUMN = 26 };
    int n = snprintf(left, sizeof left, "%s%s%s", row->name, row->argument != NULL ? " " : "",
                     row->argument != NULL ? row->argument : "");
    assert(n > 0 && (size_t)n < sizeof left);
    fprintf(out, "  %-*s%s\n", COLUMN, left, row->help);
    if (row->words != NULL)
        fprintf(out, "  %-*s%s\n", COLUMN, "", row->words);
}

void help_command(FILE *out, Command command)
{
    const CommandHelp *help = command_help;
    while (help->command != command)
        help++;
    assert(help < command_help + HELP_COUNT);
    fprintf(out, "isolux %s -- %s\n\n%s\nisolux %s %s [options]\n", command_name(command),
            help->purpose, help->examples, command_name(command), help->arguments);
    if (help->notes != NULL)
        fprintf(out, "%s", help->notes);
    fputs("\nOptions (--name VALUE or --name=VALUE):\n", out);
    const OptionRow *table = options_table();
    for (int i = 0; i < OPTION_COUNT; i++)
        if ((table[i].commands & command) != 0)
            print_option(out, &table[i]);
    fprintf(out, "\n%s", exit_codes);
}

/* --- version ---------------------------------------------------------------------------------- */

/* Called for each shared object that is loaded: names those that we chose, with their versions as
 * the file names tell them. */
static int print_library(struct dl_phdr_info *info, size_t size, void *context)
{
    static const char *const ours[] = { "libassimp", "libOpenMesh", "libOpenEXRCore", "libpng",
                                        "libjansson", "libxxhash" };
    (void)size;
    const char *slash = strrchr(info->dlpi_name, '/');
    const char *name = slash != NULL ? slash + 1 : info->dlpi_name;
    for (size_t i = 0; i < sizeof ours / sizeof *ours; i++)
        if (strncmp(name, ours[i], strlen(ours[i])) == 0)
            fprintf(context, "  library  %s\n", name);
    return 0;
}

/* The kernel that rays would be traced with: ISOLUX_ISA may force one. */
static void print_kernel(FILE *out)
{
    Error err = { 0 };
    Bvh  *bvh = bvh_create(&(Primitives){ 0 }, 1, &err);
    fprintf(out, "  kernel   %s\n", bvh != NULL ? bvh_isa(bvh) : err.text);
    bvh_destroy(bvh);
}

void help_version(FILE *out)
{
    fputs("isolux " ISOLUX_VERSION "\n", out);
    fprintf(out, "  compiler %s\n", __VERSION__);
    print_kernel(out);
#if defined __x86_64__
    __builtin_cpu_init();
    fprintf(out, "  cpu      sse2%s%s%s%s, %u threads\n", __builtin_cpu_supports("sse4.2") ?
            " sse4.2" : "", __builtin_cpu_supports("avx") ? " avx" : "",
            __builtin_cpu_supports("avx2") ? " avx2" : "",
            __builtin_cpu_supports("avx512f") ? " avx512f" : "", parallel_threads(0));
#else
    fprintf(out, "  cpu      %u threads\n", parallel_threads(0));
#endif
    dl_iterate_phdr(print_library, out);
}
