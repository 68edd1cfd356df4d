// SPDX-License-Identifier: BSD-3-Clause
// The only C++ and the only OpenMesh: half-edges behind mesh/halfedge.h.
extern "C" {
#include "mesh/halfedge.h"
}

#include <algorithm>
#include <cassert>
#include <exception>
#include <new>
#include <vector>

#include <OpenMesh/Core/Mesh/PolyConnectivity.hh>
#include <OpenMesh/Core/System/omstream.hh>

using OpenMesh::FaceHandle;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;

struct HalfEdges {
    OpenMesh::PolyConnectivity mesh;
    std::vector<int> halfedge;  // [uses]  of a use
    std::vector<uint32_t> use;  // [half-edges]  of a half-edge, HALFEDGE_NONE outside faces
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

// Whether a gap is left to turn the fans round the vertex between two rim edges so that one edge
// follows the other: the search of add_face, which ends in an assertion where there is none.
bool has_gap(const OpenMesh::PolyConnectivity &mesh, HalfedgeHandle before, HalfedgeHandle after)
{
    HalfedgeHandle h = mesh.opposite_halfedge_handle(after);
    for (size_t steps = mesh.n_halfedges(); steps > 0; steps--) {
        const HalfedgeHandle next = mesh.next_halfedge_handle(h);
        if (!next.is_valid())
            return false;
        h = mesh.opposite_halfedge_handle(next);
        if (mesh.is_boundary(h))
            return h != before && mesh.next_halfedge_handle(h).is_valid();
    }
    return false;
}

bool fits(const OpenMesh::PolyConnectivity &mesh, const std::vector<VertexHandle> &v)
{
    const size_t n = v.size();
    HalfedgeHandle before = mesh.find_halfedge(v[n - 1], v[0]);
    for (size_t k = 0; k < n; k++) {
        if (!mesh.is_boundary(v[k]))
            return false; // the fan round this vertex is closed
        const HalfedgeHandle h = mesh.find_halfedge(v[k], v[k + 1 == n ? 0 : k + 1]);
        if (h.is_valid() && !mesh.is_boundary(h))
            return false; // this side of the edge has its face
        if (h.is_valid() && before.is_valid() && mesh.next_halfedge_handle(before) != h &&
            !has_gap(mesh, before, h))
            return false; // other faces hold the two edges apart
        before = h;
    }
    return true;
}

// A face that comes to one vertex twice is no disc.
bool repeats(const std::vector<VertexHandle> &v, std::vector<int> &sorted)
{
    sorted.clear();
    for (const VertexHandle &vertex : v)
        sorted.push_back(vertex.idx());
    std::sort(sorted.begin(), sorted.end());
    return std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
}

// v: room for the face's vertices.
void add_face(HalfEdges &out, const uint32_t *corner, std::vector<VertexHandle> &v,
              uint8_t *refused)
{
    for (size_t k = 0; k < v.size(); k++)
        v[k] = VertexHandle(static_cast<int>(corner[k]));
    FaceHandle face;
    std::vector<int> sorted;
    if (!repeats(v, sorted) && fits(out.mesh, v))
        face = out.mesh.add_face(v.data(), v.size());
    *refused = face.is_valid() ? 0 : 1;
    if (!face.is_valid()) {
        for (VertexHandle &vertex : v)
            vertex = out.mesh.add_vertex();
        face = out.mesh.add_face(v.data(), v.size());
    }
    HalfedgeHandle h = out.mesh.halfedge_handle(face);
    while (out.mesh.from_vertex_handle(h) != v[0])
        h = out.mesh.next_halfedge_handle(h);
    for (size_t k = 0; k < v.size(); k++, h = out.mesh.next_halfedge_handle(h))
        out.halfedge.push_back(h.idx());
}

void fill(HalfEdges &out, const uint32_t *first, const uint32_t *corner, uint32_t face_count,
          uint32_t vertex_count, uint8_t *refused)
{
    const size_t uses = first != nullptr ? first[face_count] : 3 * static_cast<size_t>(face_count);
    out.mesh.reserve(vertex_count, uses / 2, face_count);
    out.halfedge.reserve(uses);
    for (uint32_t v = 0; v < vertex_count; v++)
        out.mesh.add_vertex();
    std::vector<VertexHandle> room;
    for (uint32_t i = 0; i < face_count; i++) {
        const size_t begin = first != nullptr ? first[i] : 3 * static_cast<size_t>(i);
        const size_t end = first != nullptr ? first[i + 1] : begin + 3;
        room.resize(end - begin);
        add_face(out, corner + begin, room, refused + i);
    }
    out.use.assign(out.mesh.n_halfedges(), HALFEDGE_NONE);
    for (size_t use = 0; use < uses; use++)
        out.use[static_cast<size_t>(out.halfedge[use])] = static_cast<uint32_t>(use);
}

} // namespace

extern "C" HalfEdges *halfedge_create(const uint32_t *first, const uint32_t *corner,
                                      uint32_t face_count, uint32_t vertex_count,
                                      uint8_t *refused, Error *err)
{
    assert(err != nullptr && (face_count == 0 || (corner != nullptr && refused != nullptr)));
    if (error_is_set(err))
        return nullptr;
    HalfEdges *out = nullptr;
    try {
        const Silence silence;
        out = new HalfEdges;
        fill(*out, first, corner, face_count, vertex_count, refused);
        return out;
    } catch (const std::bad_alloc &) {
        error_set(err, ERROR_MEMORY, "half-edges of %u faces", face_count);
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

extern "C" uint32_t halfedge_across(const HalfEdges *mesh, uint32_t use)
{
    assert(use < mesh->halfedge.size());
    const HalfedgeHandle other = mesh->mesh.opposite_halfedge_handle(
        HalfedgeHandle(mesh->halfedge[use]));
    return mesh->use[static_cast<size_t>(other.idx())];
}
