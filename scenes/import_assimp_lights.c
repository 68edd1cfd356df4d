/* SPDX-License-Identifier: BSD-3-Clause */
/* Lights and cameras of formats other than glTF, as the importing library gives them. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scenes/import_assimp.h"
#include "scenes/import_quirks.h"

static const double degrees_per_radian = 57.295779513082320877;

/* Place of the node of that name in the world. */
static bool node_find(const struct aiNode *node, const char *name, const Affine *parent,
                      Affine *world)
{
    const Affine local = affine_get(&node->mTransformation);
    const Affine here = affine_then(&local, parent);

    if (strcmp(node->mName.data, name) == 0) {
        *world = here;
        return true;
    }
    for (unsigned i = 0; i < node->mNumChildren; i++)
        if (node_find(node->mChildren[i], name, &here, world))
            return true;
    return false;
}

/* Where what is called so stands. 3DS says it in the world's axes; what the key frames say is the
 * same once more. */
static Affine place_find(const Import *import, const struct aiString *name)
{
    const struct aiNode *root = import->scene->mRootNode;
    Affine place = affine_identity();
    const Affine still = place;

    if (root != NULL && import->known.format == FORMAT_3DS)
        return affine_get(&root->mTransformation);
    if (root != NULL)
        (void)node_find(root, name->data, &still, &place);
    return place;
}

static Vec3 vec3_get(const struct aiVector3D *v)
{
    return vec3((double)v->x, (double)v->y, (double)v->z);
}

/* The whole horizontal angle of a camera, radians. 3DS gives a focal length, which assimp takes for
 * degrees: the format's programs see 2400 degrees over it. */
static double camera_width(const Import *import, const struct aiCamera *from)
{
    const double angle = (double)from->mHorizontalFOV;

    return import->known.format == FORMAT_3DS
           ? 2400 / (angle * degrees_per_radian) / degrees_per_radian : angle;
}

void import_camera_send(Import *import, const struct aiCamera *from)
{
    const Affine world = place_find(import, &from->mName);
    const double half = tan(camera_width(import, from) / 2);
    const Vec3 ahead = vec3_get(&from->mLookAt);
    Vec3 up = vec3_get(&from->mUp);
    Camera camera = { .aspect = from->mAspect > 0 ? (double)from->mAspect : 0 };

    if (import->known.format == FORMAT_3DS)
        up = discreet_up(vec3_unit(ahead), up);
    camera.eye = affine_point(&world, vec3_get(&from->mPosition));
    const Vec3 look = affine_vector(&world, ahead);
    camera.target = vec3_add(camera.eye, vec3_unit(look));
    camera.up = vec3_unit(affine_vector(&world, up));
    /* Without an aspect the view counts as square. */
    camera.vertical_fov = 2 * degrees_per_radian
                          * atan(half / (camera.aspect > 0 ? camera.aspect : 1));
    snprintf(camera.name, sizeof camera.name, "%.63s", from->mName.data);
    if (!(camera.vertical_fov > 0 && camera.vertical_fov < 180) || !isfinite(camera.aspect) ||
        !vec3_finite(camera.eye) || !(vec3_length(vec3_cross(look, camera.up)) > 0)) {
        pipe_put_warning(import->out, "camera-ignored", camera.name, "it does not look anywhere");
        return;
    }
    pipe_put_camera(import->out, &camera);
}

double import_root_scale(const Import *import)
{
    const struct aiNode *node = import->scene->mRootNode;
    const Affine root = node != NULL ? affine_get(&node->mTransformation) : affine_identity();
    return cbrt(fabs(affine_determinant(&root)));
}

/* What the light's colour is divided by at a distance of 1: its fall with the square of distance,
 * which files give in their own unit. FBX has no such number, but assimp makes one up. */
static double light_fall(const Import *import, const struct aiLight *from)
{
    const double unit = import_root_scale(import);

    if (import->known.format == FORMAT_FBX || !(from->mAttenuationQuadratic > 0) || !(unit > 0) ||
        !isfinite(from->mAttenuationQuadratic))
        return 1;
    return (double)from->mAttenuationQuadratic / (unit * unit);
}

void import_light_send(Import *import, const struct aiLight *from)
{
    const Affine world = place_find(import, &from->mName);
    Light light = { .kind = LIGHT_POINT, .cos_inner = -1, .cos_outer = -1 };

    snprintf(light.name, sizeof light.name, "%.63s", from->mName.data);
    if (from->mType != aiLightSource_POINT && from->mType != aiLightSource_SPOT) {
        pipe_put_warning(import->out, "light-ignored", light.name,
                         "only point and spot lights can be used");
        return;
    }
    light.position = affine_point(&world, vec3_get(&from->mPosition));
    light.direction = vec3_unit(affine_vector(&world, vec3_get(&from->mDirection)));
    light.intensity = rgb_scale(rgb((double)from->mColorDiffuse.r, (double)from->mColorDiffuse.g,
                                    (double)from->mColorDiffuse.b), 1 / light_fall(import, from));
    const Rgb i = light.intensity;
    if (!vec3_finite(light.position) || !vec3_finite(light.direction) ||
        !(i.r >= 0 && i.g >= 0 && i.b >= 0 && isfinite(i.r + i.g + i.b))) {
        pipe_put_warning(import->out, "light-ignored", light.name,
                         "its place or intensity is not finite or below 0");
        return;
    }
    if (from->mType == aiLightSource_SPOT)
        spot_cones(&light, import->known.format == FORMAT_3DS,
                   import->known.format == FORMAT_COLLADA && !import->known.cones,
                   (double)from->mAngleInnerCone, (double)from->mAngleOuterCone);
    pipe_put_warning(import->out, "light-units", light.name,
                     "this format gives lights no unit: the intensity is taken as candela");
    pipe_put_light(import->out, &light);
}
