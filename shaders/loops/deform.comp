#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/when.glsl"
// Moves the map with the deformation graph: each live surfel by its four nearest nodes in space and time, as
// DeformationGraph::deform does; normals by the blended rotation. Which nodes these can be is listed in the surfel's
// leaf of the influence tree.
// An invocation takes four surfels that follow each other (SURFELS_PER_INVOCATION): mostly neighbours on a surface, so
// that they share a leaf and a node is fetched once for all four. Their components lie side by side: x = (x of the
// first, ..., x of the fourth).
// push: metres_per_frame, temporal_window (frames): convert a distance in time into one in space
// in:  tree, leaves, lists of candidates, nodes; appearance (created); counters.count
// out: position_confidence, normal_radius
layout(local_size_x = GROUP) in;
layout(constant_id = 0) const float INFLUENCE_MARGIN = 1.0;  // kInfluenceMargin
layout(push_constant) uniform Push { float metres_per_frame, temporal_window; };
readonly buffer Counters { MapRecord counters; };
readonly buffer Appearances { uvec4 appearance[]; };
readonly buffer Branches { DeformBranch branches[]; };
readonly buffer Leaves { DeformLeaf leaves[]; };
readonly buffer Candidates { uvec4 candidates[]; };  // each DeformCandidate as two vectors: two loads, not four
readonly buffer Nodes { DeformNode nodes[]; };
buffer Positions { vec4 position_confidence[]; };
buffer Normals { vec4 normal_radius[]; };

const float FAR = 1e30;           // squared metres
const float MIN_DIVISOR = 1e-20;  // no division by 0

struct Four {
    vec4 x, y, z;
};

// Squared distance in space and time.
vec4 distance2(Four p, vec4 frame, vec4 position_created, float last_seen) {
    vec4 dx = p.x - position_created.x, dy = p.y - position_created.y, dz = p.z - position_created.z;
    vec4 dt = metres_per_frame * max(vec4(0.0), max(position_created.w - frame, frame - last_seen) - temporal_window);
    return dx * dx + dy * dy + dz * dz + dt * dt;
}

uint leaf_of(vec4 point) {
    DeformBranch at = branches[0];
    uint axis = at.link % DEFORM_LINK;
    while (axis != DEFORM_LEAF) {
        float x = axis < 2u ? (axis == 0u ? point.x : point.y) : (axis == 2u ? point.z : point.w);
        at = branches[at.link / DEFORM_LINK + uint(x >= at.split)];
        axis = at.link % DEFORM_LINK;
    }
    return at.link / DEFORM_LINK;
}

vec4 within(vec4 x, float low, float high) {
    return vec4(greaterThanEqual(x, vec4(low))) * vec4(lessThan(x, vec4(high)));
}

void main() {
    uint first = SURFELS_PER_INVOCATION * gl_GlobalInvocationID.x;
    if (first >= counters.count) return;
    uvec4 i = min(first + uvec4(0u, 1u, 2u, 3u), uvec4(counters.count - 1u));
    mat4 surfels = mat4(position_confidence[i.x], position_confidence[i.y], position_confidence[i.z],
                        position_confidence[i.w]);
    mat4 shapes = mat4(normal_radius[i.x], normal_radius[i.y], normal_radius[i.z], normal_radius[i.w]);
    vec4 frame = vec4(appearance[i.x][CREATED], appearance[i.y][CREATED], appearance[i.z][CREATED],
                      appearance[i.w][CREATED]);
    mat4 rows = transpose(surfels), normal_rows = transpose(shapes);
    Four p = Four(rows[0], rows[1], rows[2]);
    Four n = Four(normal_rows[0], normal_rows[1], normal_rows[2]);
    Four moved = p, turned = n;
    vec4 live = vec4(greaterThan(rows[3], vec4(0.0))) * vec4(equal(i, first + uvec4(0u, 1u, 2u, 3u)));

    vec4 waiting = live;
    while (dot(waiting, vec4(1.0)) > 0.0) {
        // the leaf of the first surfel not done yet, and all surfels that are in it
        vec4 chosen = waiting.x > 0.0   ? vec4(1, 0, 0, 0)
                      : waiting.y > 0.0 ? vec4(0, 1, 0, 0)
                      : waiting.z > 0.0 ? vec4(0, 0, 1, 0)
                                        : vec4(0, 0, 0, 1);
        uint index = leaf_of(vec4(dot(chosen, p.x), dot(chosen, p.y), dot(chosen, p.z), dot(chosen, frame)));
        DeformLeaf leaf = leaves[index];
        vec4 here = within(p.x, leaf.low.x, leaf.high.x) * within(p.y, leaf.low.y, leaf.high.y) *
                    within(p.z, leaf.low.z, leaf.high.z) * within(frame, leaf.low.w, leaf.high.w);
        here = max(here, chosen) * waiting;
        waiting -= here;

        // the five smallest distances, ascending; candidates are sorted, so that the loop ends early
        vec4 d0 = vec4(FAR), d1 = vec4(FAR), d2 = vec4(FAR), d3 = vec4(FAR), d4 = vec4(FAR);
        float reach2 = FAR;
        for (uint k = leaf.begin; k < leaf.end; ++k) {
            uvec4 candidate = candidates[2u * k + 1u];
            if (uintBitsToFloat(candidate.y) >= reach2) break;
            vec4 d = distance2(p, frame, uintBitsToFloat(candidates[2u * k]), uintBitsToFloat(candidate.x));
            d4 = min(d4, max(d3, d));
            d3 = min(d3, max(d2, d));
            d2 = min(d2, max(d1, d));
            d1 = min(d1, max(d0, d));
            d0 = min(d0, d);
            vec4 here4 = here * d4;
            reach2 = max(max(here4.x, here4.y), max(here4.z, here4.w));
        }
        vec4 per_reach = 1.0 / sqrt(max(d4, vec4(MIN_DIVISOR)));
        reach2 *= (1.0 + INFLUENCE_MARGIN) * (1.0 + INFLUENCE_MARGIN);

        // sum of w (R - I), of w t, of w: the weight of the fifth is negligible, that of all others zero
        vec4 xx = vec4(0), xy = vec4(0), xz = vec4(0), yx = vec4(0), yy = vec4(0), yz = vec4(0);
        vec4 zx = vec4(0), zy = vec4(0), zz = vec4(0);
        vec4 tx = vec4(0), ty = vec4(0), tz = vec4(0), sum = vec4(0);
        for (uint k = leaf.begin; k < leaf.end; ++k) {
            uvec4 candidate = candidates[2u * k + 1u];
            if (uintBitsToFloat(candidate.y) >= reach2) break;
            vec4 d = distance2(p, frame, uintBitsToFloat(candidates[2u * k]), uintBitsToFloat(candidate.x));
            vec4 w = max(vec4(0.0), 1.0 + INFLUENCE_MARGIN - sqrt(d) * per_reach);
            w *= w * here;
            sum += w;
            WHEN(dot(w, vec4(1.0)) > 0.0) {
                uint node = candidate.z;
                vec3 t = nodes[node].translation.xyz;
                vec4 q = nodes[node].rotation;
                tx += w * t.x;
                ty += w * t.y;
                tz += w * t.z;
                vec3 s = 2.0 * q.xyz * q.xyz, c = 2.0 * q.yzx * q.zxy, r = 2.0 * q.w * q.xyz;
                xx -= w * (s.y + s.z);
                xy += w * (c.z - r.z);
                xz += w * (c.y + r.y);
                yx += w * (c.z + r.z);
                yy -= w * (s.x + s.z);
                yz += w * (c.x - r.x);
                zx += w * (c.y - r.y);
                zy += w * (c.x + r.x);
                zz -= w * (s.x + s.y);
            }
        }
        vec4 share = here / max(sum, vec4(MIN_DIVISOR));
        moved.x += share * (xx * p.x + xy * p.y + xz * p.z + tx);
        moved.y += share * (yx * p.x + yy * p.y + yz * p.z + ty);
        moved.z += share * (zx * p.x + zy * p.y + zz * p.z + tz);
        turned.x += share * (xx * n.x + xy * n.y + xz * n.z);
        turned.y += share * (yx * n.x + yy * n.y + yz * n.z);
        turned.z += share * (zx * n.x + zy * n.y + zz * n.z);
    }

    vec4 length2 = turned.x * turned.x + turned.y * turned.y + turned.z * turned.z;
    vec4 scale = 1.0 / sqrt(max(length2, vec4(MIN_DIVISOR)));
    for (uint k = 0u; k < SURFELS_PER_INVOCATION; ++k) {
        if (live[k] <= 0.0) continue;
        position_confidence[first + k] = vec4(moved.x[k], moved.y[k], moved.z[k], rows[3][k]);
        vec3 normal = vec3(turned.x[k], turned.y[k], turned.z[k]) * scale[k];
        normal_radius[first + k] = vec4(normal, normal_rows[3][k]);
    }
}
