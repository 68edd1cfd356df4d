// SPDX-License-Identifier: BSD-3-Clause
// The only C++ and the only OpenMesh: half-edges behind mesh/halfedge.h.
extern "C" {
#include "mesh/halfedge.h"
}

#include <cassert>
#include <exception>
#include <new>
#include <vector>

#include <OpenMesh/Core/Mesh/TriConnectivity.hh>
#include <OpenMesh/Core/System/omstream.hh>

using OpenMesh::FaceHandle;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;

struct HalfEdges {
    OpenMesh::TriConnectivity mesh;
    std::vector<int> start; // [triangles]  half-edge from corner 0 to corner 1
};

namespace {

// OpenMesh says on its error stream what it refuses; a library must not print.
class Silence {
public:
    Silence() : was_(omerr().is_enabled()) { omerr().disable(); }
    ~Silence()
    {
        if (was_)
            omerr().enable();
    }
    Silence(const Silence &) = delete;
    Silence &operator=(const Silence &) = delete;

private:
    bool was_;
};

bool fits(const OpenMesh::TriConnectivity &mesh, const VertexHandle v[3])
{
    for (int k = 0; k < 3; k++) {
        if (!mesh.is_boundary(v[k]))
            return false; // the fan round this vertex is closed
        const HalfedgeHandle h = mesh.find_halfedge(v[k], v[(k + 1) % 3]);
        if (h.is_valid() && !mesh.is_boundary(h))
            return false; // this side of the edge has its face
    }
    return true;
}

void add_triangle(HalfEdges &out, const uint32_t *corner, uint8_t *refused)
{
    VertexHandle v[3];
    for (int k = 0; k < 3; k++)
        v[k] = VertexHandle(static_cast<int>(corner[k]));
    FaceHandle face;
    if (fits(out.mesh, v))
        face = out.mesh.add_face(v, 3);
    *refused = face.is_valid() ? 0 : 1;
    if (!face.is_valid()) {
        for (int k = 0; k < 3; k++)
            v[k] = out.mesh.add_vertex();
        face = out.mesh.add_face(v, 3);
    }
    HalfedgeHandle h = out.mesh.halfedge_handle(face);
    while (out.mesh.from_vertex_handle(h) != v[0])
        h = out.mesh.next_halfedge_handle(h);
    out.start.push_back(h.idx());
}

} // namespace

extern "C" HalfEdges *halfedge_create(const uint32_t *corner, uint32_t triangle_count,
                                      uint32_t vertex_count, uint8_t *refused, Error *err)
{
    assert(err != nullptr && (triangle_count == 0 || (corner != nullptr && refused != nullptr)));
    if (error_is_set(err))
        return nullptr;
    HalfEdges *out = nullptr;
    try {
        const Silence silence;
        out = new HalfEdges;
        out->mesh.reserve(vertex_count, triangle_count + triangle_count / 2, triangle_count);
        out->start.reserve(triangle_count);
        for (uint32_t v = 0; v < vertex_count; v++)
            out->mesh.add_vertex();
        for (uint32_t i = 0; i < triangle_count; i++)
            add_triangle(*out, corner + 3 * static_cast<size_t>(i), refused + i);
        return out;
    } catch (const std::bad_alloc &) {
        error_set(err, ERROR_MEMORY, "half-edges of %u triangles", triangle_count);
    } catch (const std::exception &e) {
        error_set(err, ERROR_FAILED, "OpenMesh: %s", e.what());
    } catch (...) {
        error_set(err, ERROR_FAILED, "OpenMesh: unknown exception");
    }
    return halfedge_destroy(out);
}

extern "C" HalfEdges *halfedge_destroy(HalfEdges *mesh)
{
    delete mesh;
    return nullptr;
}

extern "C" uint32_t halfedge_across(const HalfEdges *mesh, uint32_t triangle, unsigned k,
                                    unsigned *edge)
{
    assert(triangle < mesh->start.size() && k < 3);
    HalfedgeHandle h(mesh->start[triangle]);
    for (unsigned i = 0; i < k; i++)
        h = mesh->mesh.next_halfedge_handle(h);
    const HalfedgeHandle other = mesh->mesh.opposite_halfedge_handle(h);
    const FaceHandle face = mesh->mesh.face_handle(other);
    if (!face.is_valid())
        return HALFEDGE_NONE;
    HalfedgeHandle walk(mesh->start[static_cast<size_t>(face.idx())]);
    for (*edge = 0; walk != other; walk = mesh->mesh.next_halfedge_handle(walk))
        ++*edge;
    assert(*edge < 3);
    return static_cast<uint32_t>(face.idx());
}
