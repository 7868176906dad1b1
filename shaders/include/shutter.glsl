// The camera's motion while a frame is taken: that between the previous pose and its own, but for how it turns.
#ifndef POSEFUSION_SHUTTER
#define POSEFUSION_SHUTTER
#include "se3.glsl"

Twist scaled(Twist twist, float factor) {
    return Twist(factor * twist.translation, factor * twist.rotation);
}

Twist sum(Twist a, Twist b) {
    return Twist(a.translation + b.translation, a.rotation + b.rotation);
}

Twist no_motion() {
    return Twist(vec4(0.0), vec4(0.0));
}

// A point that was seen `time` seconds after the frame's stamp, as seen at the stamp: to second order, which is good to
// 0.01 pixels at 3 rad/s over 15 ms. @param acceleration  of the turn, rad/s^2
vec3 at_stamp(Twist motion, vec3 acceleration, float time, vec3 p) {
    vec3 turn = motion.rotation.xyz + 0.5 * time * acceleration;
    vec3 moved = time * (motion.translation.xyz + cross(turn, p));
    return p + moved + 0.5 * time * cross(turn, moved);
}

// How fast a point seen at the time of its row moves in the frame of the model, by the motion of the camera.
vec3 moved_per_second(Pose T_model_live, Twist motion, vec3 p) {
    return rotate(T_model_live, motion.translation.xyz + cross(motion.rotation.xyz, p));
}

// The constant motion that leads from the previous pose to this one in `interval` seconds. translation.w = 1: known.
Twist mean_motion(Pose T_before_now, float interval) {
    if (!(interval > 0.0)) return no_motion();
    vec3 rotation = log_rotation(T_before_now);
    vec3 t = translation(T_before_now);
    return Twist(vec4((t - 0.5 * cross(rotation, t)) / interval, 1.0), vec4(rotation / interval, 0.0));
}

// Where a constant motion leads in `interval` seconds, metres: the inverse of mean_motion(), to the same order.
vec3 shift_after(Twist motion, float interval) {
    vec3 t = interval * motion.translation.xyz;
    return t + 0.5 * cross(interval * motion.rotation.xyz, t);
}

// The motion at the stamp, as far as turning is known better than from the poses.
Twist with_turn(Twist motion, vec4 turn_offset) {
    return Twist(motion.translation, motion.rotation + turn_offset);
}

// The motion at the next stamp. Turning goes on as at this stamp, and half as much faster as it has become: hands
// tremble, so that acceleration does not last. Translation is too uncertain to say how it changes.
Twist next_motion(Twist last, Twist last_but_one, vec4 turn_offset) {
    vec4 faster = last_but_one.translation.w == 0.0 ? vec4(0.0) : 0.5 * (last.rotation - last_but_one.rotation);
    return Twist(last.translation, last.rotation + turn_offset + faster);
}

#endif
