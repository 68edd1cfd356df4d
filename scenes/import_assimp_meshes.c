/* SPDX-License-Identifier: BSD-3-Clause */
/* Nodes and their meshes, as the importing library gives them: as faces where each node stands, or,
 * when that would be very many, a mesh once and the places of its nodes. */
#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "scenes/import_assimp.h"

/* --- parts ------------------------------------------------------------------------------------ */

static bool corners_check(const Import *import, const struct aiMesh *mesh, const char *group)
{
    for (unsigned i = 0; i < mesh->mNumFaces; i++)
        for (unsigned k = 0; k < mesh->mFaces[i].mNumIndices; k++)
            if (mesh->mFaces[i].mIndices[k] >= mesh->mNumVertices)
                return error_at(import->err, ERROR_INPUT, import->path, 0,
                                "face %u of object \"%.80s\" names vertex %u of %u", i, group,
                                mesh->mFaces[i].mIndices[k], mesh->mNumVertices);
    return true;
}

/* assimp leaves out faces with an index out of range and says nothing. */
static bool gltf_faces_check(const Import *import, const struct aiMesh *mesh, const char *group)
{
    size_t index, primitive = 0;
    const Gltf *gltf = import->known.gltf;

    if (sscanf(mesh->mName.data, "a%zu-%zu", &index, &primitive) < 1 ||
        index >= gltf->mesh_count ||
        primitive >= gltf->first_primitive[index + 1] - gltf->first_primitive[index])
        return true;
    const uint64_t wanted = gltf->faces[gltf->first_primitive[index] + primitive];
    if (wanted > 0 && wanted != mesh->mNumFaces)
        return error_at(import->err, ERROR_INPUT, import->path, 0,
                        "object \"%.80s\" has indices out of range (%llu of %llu triangles are "
                        "good)", group, (unsigned long long)mesh->mNumFaces,
                        (unsigned long long)wanted);
    return true;
}

static void faces_send(const Import *import, const struct aiMesh *mesh, bool mirrored)
{
    for (unsigned i = 0; i < mesh->mNumFaces; i++)
        if (mesh->mFaces[i].mNumIndices >= 3)
            pipe_put_u32(import->out, mesh->mFaces[i].mNumIndices);
    for (unsigned i = 0; i < mesh->mNumFaces; i++) {
        const struct aiFace *face = &mesh->mFaces[i];
        for (unsigned k = 0; k < face->mNumIndices && face->mNumIndices >= 3; k++)
            pipe_put_u32(import->out, face->mIndices[mirrored ? face->mNumIndices - 1 - k : k]);
    }
}

/* Where the vertices are in the image of the mesh's material; NULL: it has none. */
static const struct aiVector3D *places_of(const Import *import, const struct aiMesh *mesh)
{
    const unsigned m = mesh->mMaterialIndex;
    const unsigned set = m < import->scene->mNumMaterials ? import->place[m].set : 0;
    return set > 0 && set <= AI_MAX_NUMBER_OF_TEXTURECOORDS ? mesh->mTextureCoords[set - 1] : NULL;
}

/* Normals for shading. Those of STL are its facets' own, and tell nothing else. */
static const struct aiVector3D *normals_of(const Import *import, const struct aiMesh *mesh)
{
    return import->known.format == FORMAT_STL ? NULL : mesh->mNormals;
}

static bool mesh_check(Import *import, const struct aiMesh *mesh, const char *group)
{
    return corners_check(import, mesh, group) &&
           (import->known.gltf == NULL || gltf_faces_check(import, mesh, group));
}

static uint32_t faces_of(const struct aiMesh *mesh)
{
    uint32_t faces = 0;
    for (unsigned i = 0; i < mesh->mNumFaces; i++)
        faces += mesh->mFaces[i].mNumIndices >= 3;
    return faces;
}

static uint32_t material_of(const Import *import, const struct aiMesh *mesh)
{
    return mesh->mMaterialIndex < import->scene->mNumMaterials
           ? import->material[mesh->mMaterialIndex] : PIPE_NO_MATERIAL;
}

static void vertices_send(const Import *import, const struct aiMesh *mesh, const Affine *world)
{
    for (unsigned i = 0; i < mesh->mNumVertices; i++) {
        const struct aiVector3D p = mesh->mVertices[i];
        pipe_put_vec3(import->out,
                      affine_point(world, vec3((double)p.x, (double)p.y, (double)p.z)));
    }
}

static void normals_send(const Import *import, const struct aiMesh *mesh, const Affine *world)
{
    const struct aiVector3D *n = normals_of(import, mesh);
    for (unsigned i = 0; n != NULL && i < mesh->mNumVertices; i++)
        pipe_put_vec3(import->out, affine_cofactor(world, vec3((double)n[i].x, (double)n[i].y,
                                                               (double)n[i].z)));
}

static bool mesh_send(Import *import, const struct aiMesh *mesh, const Affine *world,
                      const char *group)
{
    const uint32_t faces = faces_of(mesh);

    if (!mesh_check(import, mesh, group))
        return false;
    for (unsigned i = 0; i < mesh->mNumFaces; i++)
        import->loose += mesh->mFaces[i].mNumIndices == 1 || mesh->mFaces[i].mNumIndices == 2;
    import->faces += faces;
    if (faces == 0)
        return true;
    pipe_put_kind(import->out, RECORD_PART);
    pipe_put_text(import->out, group);
    pipe_put_u32(import->out, material_of(import, mesh));
    pipe_put_u32(import->out, mesh->mNumVertices);
    pipe_put_u32(import->out, faces);
    const struct aiVector3D *places = places_of(import, mesh);
    pipe_put_u32(import->out, places != NULL);
    pipe_put_u32(import->out, normals_of(import, mesh) != NULL);
    vertices_send(import, mesh, world);
    normals_send(import, mesh, world);
    for (unsigned i = 0; places != NULL && i < mesh->mNumVertices; i++)
        child_place_send(import->out, &import->place[mesh->mMaterialIndex], (double)places[i].x,
                         (double)places[i].y);
    faces_send(import, mesh, affine_determinant(world) < 0);
    import->own = true;
    return !import->out->broken;
}

/* --- by reference ----------------------------------------------------------------------------- */

static bool uses_count(Import *import, const struct aiNode *node)
{
    for (unsigned i = 0; i < node->mNumMeshes; i++) {
        if (node->mMeshes[i] >= import->scene->mNumMeshes)
            return error_at(import->err, ERROR_INPUT, import->path, 0, "a mesh is missing");
        import->use[node->mMeshes[i]].uses++;
    }
    for (unsigned i = 0; i < node->mNumChildren; i++)
        if (!uses_count(import, node->mChildren[i]))
            return false;
    return true;
}

/* Meshes of several nodes, all of them or none. Where an image is, each copy has faces: places in
 * the image go with faces. */
static void uses_decide(Import *import)
{
    const PipeWish *wish = &import->out->wish;
    uint64_t again = 0;

    for (unsigned i = 0; i < import->scene->mNumMeshes; i++) {
        const struct aiMesh *mesh = import->scene->mMeshes[i];
        MeshUse *use = &import->use[i];
        use->number = PIPE_NO_MESH;
        use->placed = use->uses > 1 && places_of(import, mesh) == NULL && faces_of(mesh) > 0;
        import->own |= use->uses > 0 && !use->placed && faces_of(mesh) > 0;
        again += use->placed ? (uint64_t)(use->uses - 1) * faces_of(mesh) : 0;
    }
    const bool keep = wish->instances == INSTANCES_KEEP ||
                      (wish->instances == INSTANCES_AUTO && again > wish->most);
    for (unsigned i = 0; i < import->scene->mNumMeshes && !keep; i++)
        import->use[i].placed = false;
}

/* The mesh in its own space when it comes for the first time, then where it stands. */
static bool place_send(Import *import, const struct aiMesh *mesh, MeshUse *use,
                       const Affine *world, const char *group)
{
    const Affine still = affine_identity();
    const uint32_t faces = faces_of(mesh);

    if (use->number == PIPE_NO_MESH) {
        if (!mesh_check(import, mesh, group))
            return false;
        pipe_put_kind(import->out, RECORD_MESH);
        pipe_put_u32(import->out, mesh->mNumVertices);
        pipe_put_u32(import->out, faces);
        pipe_put_u32(import->out, normals_of(import, mesh) != NULL);
        vertices_send(import, mesh, &still);
        normals_send(import, mesh, &still);
        faces_send(import, mesh, false);
        use->number = import->sent++;
    }
    pipe_put_kind(import->out, RECORD_PLACE);
    pipe_put_text(import->out, group);
    pipe_put_u32(import->out, use->number);
    pipe_put_u32(import->out, material_of(import, mesh));
    pipe_put_vec3(import->out, world->x);
    pipe_put_vec3(import->out, world->y);
    pipe_put_vec3(import->out, world->z);
    pipe_put_vec3(import->out, world->t);
    import->faces += faces;
    return !import->out->broken;
}

/* --- nodes ------------------------------------------------------------------------------------ */

/* Names in angle brackets are assimp's own. In 3DS a mesh is called by its number. */
static const char *group_name(const Import *import, const struct aiNode *node,
                              const struct aiMesh *mesh)
{
    size_t index;

    if (sscanf(mesh->mName.data, "%zu", &index) == 1 && index < import->known.name_count)
        return import->known.name[index];
    if (node->mName.length > 0 && node->mName.data[0] != '<')
        return node->mName.data;
    return mesh->mName.length > 0 && mesh->mName.data[0] != '<' ? mesh->mName.data : "";
}

static bool node_send(Import *import, const struct aiNode *node, const Affine *parent)
{
    const Affine local = affine_get(&node->mTransformation);
    Affine world = affine_then(&local, parent);
    const char *name = NULL;
    size_t index;

    if (import->known.gltf != NULL && sscanf(node->mName.data, "n%zu", &index) == 1 &&
        index < import->known.gltf->node_count) {
        world = import->known.gltf->node[index].world;
        name = import->known.gltf->node[index].name;
    }
    for (unsigned i = 0; i < node->mNumMeshes; i++) {
        const struct aiMesh *mesh = import->scene->mMeshes[node->mMeshes[i]];
        MeshUse *use = &import->use[node->mMeshes[i]];
        const char *group = name != NULL ? name : group_name(import, node, mesh);
        Affine back;
        /* A mesh pressed flat cannot be placed; and whatever looks at the scene's own faces finds
         * some. */
        const bool placed = use->placed && import->own && affine_invert(&world, &back);
        if (!(placed ? place_send(import, mesh, use, &world, group)
                     : mesh_send(import, mesh, &world, group)))
            return false;
        use->shown = true;
    }
    for (unsigned i = 0; i < node->mNumChildren; i++)
        if (!node_send(import, node->mChildren[i], &world))
            return false;
    return true;
}

/* A 3DS file may have key frames for some of its meshes: assimp forgets the others. */
static bool forgotten_send(Import *import)
{
    const struct aiNode *root = import->scene->mRootNode;

    if (root == NULL)
        return true;
    const Affine world = affine_get(&root->mTransformation);
    for (unsigned i = 0; import->known.format == FORMAT_3DS && i < import->scene->mNumMeshes; i++) {
        const struct aiMesh *mesh = import->scene->mMeshes[i];
        if (!import->use[i].shown &&
            !mesh_send(import, mesh, &world, group_name(import, root, mesh)))
            return false;
    }
    return true;
}

bool import_meshes_send(Import *import)
{
    assert(import != NULL && import->scene != NULL);
    const struct aiScene *scene = import->scene;
    const Affine still = affine_identity();

    import->use = array_create(scene->mNumMeshes, sizeof *import->use, "meshes", import->err);
    if (import->use == NULL || (scene->mRootNode != NULL && !uses_count(import, scene->mRootNode)))
        return false;
    uses_decide(import);
    return (scene->mRootNode == NULL || node_send(import, scene->mRootNode, &still)) &&
           forgotten_send(import);
}
