#!/usr/bin/env python3
"""`posefusion evaluate` against the definitions it follows, written down once more in NumPy: six digits must agree.

TUM: evaluate_ate.py and evaluate_rpe.py of the RGB-D benchmark (Sturm et al., IROS 2012). evo: nearest association,
SE(3) and Sim(3) alignment by Umeyama (PAMI 1991), pairs by frames, metres and degrees, errors Q^-1 P.
Usage: reference_test.py PROGRAM SHARED_DATA
"""
import json
import math
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

PROGRAM, SHARED = sys.argv.pop(1), Path(sys.argv.pop(1))


def quaternion(rotation):
    """x y z w of a rotation less than half a turn"""
    w = math.sqrt(max(0.0, 1 + np.trace(rotation))) / 2
    x, y, z = ((rotation[2, 1] - rotation[1, 2]), (rotation[0, 2] - rotation[2, 0]), (rotation[1, 0] - rotation[0, 1]))
    return np.array([x / (4 * w), y / (4 * w), z / (4 * w), w])


def rotation_of(x, y, z, w):
    x, y, z, w = np.array([x, y, z, w]) / math.sqrt(x * x + y * y + z * z + w * w)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def rotation_about(axis, angle):
    """Rodrigues"""
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def pose(rotation, position):
    result = np.eye(4)
    result[:3, :3], result[:3, 3] = rotation, position
    return result


def read_tum(file):
    rows = np.loadtxt(file)
    return rows[:, 0], [pose(rotation_of(*row[4:8]), row[1:4]) for row in rows]


def angle_deg(rotation):
    """Of one rotation or of each of a stack; well-conditioned also for small angles, where the arc cosine is not."""
    skew = (rotation - np.swapaxes(rotation, -1, -2))[..., [2, 0, 1], [1, 2, 0]] / 2
    cosine = (np.trace(rotation, axis1=-2, axis2=-1) - 1) / 2
    return np.degrees(np.arctan2(np.linalg.norm(skew, axis=-1), cosine))


def associate_tum(first, second, limit):
    candidates = sorted(
        (abs(a - second[j]), i, j) for i, a in enumerate(first) for j in np.flatnonzero(np.abs(second - a) < limit)
    )
    used_i, used_j, pairs = set(), set(), []
    for _, i, j in candidates:
        if i not in used_i and j not in used_j:
            used_i.add(i), used_j.add(j), pairs.append((i, j))
    return sorted(pairs)


def associate_evo(truth, estimate, limit):
    swap = len(truth) < len(estimate)
    few, many = (truth, estimate) if swap else (estimate, truth)
    pairs = []
    for i, stamp in enumerate(few):
        differences = np.abs(many - stamp)
        j = int(np.argmin(differences))
        if differences[j] <= limit:
            pairs.append((i, j) if swap else (j, i))
    return pairs


def umeyama(model, truth, with_scale):
    """s, R, t with truth = s R model + t; equations 39 to 43 of the paper"""
    mean_x, mean_y = model.mean(axis=0), truth.mean(axis=0)
    covariance = (truth - mean_y).T @ (model - mean_x) / len(model)
    u, d, vt = np.linalg.svd(covariance)
    sign = np.eye(3)
    if np.linalg.det(u) * np.linalg.det(vt) < 0:
        sign[2, 2] = -1
    rotation = u @ sign @ vt
    scale = np.trace(np.diag(d) @ sign) / ((model - mean_x) ** 2).sum() * len(model) if with_scale else 1.0
    return scale, rotation, mean_y - scale * rotation @ mean_x


def positions(poses):
    return np.array([p[:3, 3] for p in poses])


def best_time_offset(truth_stamps, truth, stamps, model, around):
    """Least distance between the aligned positions and the true path, of the offsets within 10 ms of `around`."""

    def rmse(offset):
        true = np.array([np.interp(stamps + offset, truth_stamps, axis) for axis in positions(truth).T]).T
        scale, rotation, translation = umeyama(positions(model), true, True)
        return np.sqrt(((scale * positions(model) @ rotation.T + translation - true) ** 2).sum(axis=1).mean())

    return min(np.arange(around - 0.01, around + 0.01, 0.0001), key=rmse)


def scaled(poses, scale):
    return [pose(p[:3, :3], scale * p[:3, 3]) for p in poses]


def inverse(p):
    return pose(p[:3, :3].T, -p[:3, :3].T @ p[:3, 3])


def statistics(errors):
    errors = np.asarray(errors)
    return {
        "pairs": len(errors),
        "rmse": math.sqrt((errors**2).mean()),
        "mean": errors.mean(),
        "median": np.median(errors),
        "std": errors.std(),
        "min": errors.min(),
        "max": errors.max(),
    }


def absolute_errors(truth, model, align, with_scale):
    """of matched poses -> scale, distances, angles"""
    scale, rotation, translation = umeyama(positions(model), positions(truth), with_scale)
    model = scaled(model, scale)
    if align == "none":
        rotation, translation = np.eye(3), np.zeros(3)
    placed = pose(rotation, translation) if align != "origin" else truth[0] @ inverse(model[0])
    model = [placed @ p for p in model]
    return (
        scale,
        [np.linalg.norm(m[:3, 3] - t[:3, 3]) for t, m in zip(truth, model)],
        [angle_deg(t[:3, :3].T @ m[:3, :3]) for t, m in zip(truth, model)],
    )


def relative_errors_tum(truth_stamps, truth, stamps, model, delta):
    longest = 2 * np.median(np.diff(truth_stamps))
    nearest = lambda all_stamps, stamp: int(np.argmin(np.abs(all_stamps - stamp)))
    errors = []
    for i, stamp in enumerate(stamps):
        j = nearest(stamps, stamp + delta)
        if j == len(stamps) - 1:
            continue
        a, b = nearest(truth_stamps, stamp), nearest(truth_stamps, stamps[j])
        if abs(truth_stamps[a] - stamp) > longest or abs(truth_stamps[b] - stamps[j]) > longest:
            continue
        errors.append(inverse(model[i]) @ model[j] @ inverse(inverse(truth[a]) @ truth[b]))
    return errors


def pairs_evo(model, unit, delta, all_pairs):
    n = len(model)
    if unit == "frames":
        starts = range(n) if all_pairs else range(0, n, int(delta))
        return [(i, i + int(delta)) for i in starts if i + int(delta) < n]
    if unit == "m":
        steps = np.linalg.norm(np.diff(positions(model), axis=0), axis=1)
        if all_pairs:
            way, pairs = np.concatenate([[0], np.cumsum(steps)]), []
            for i in range(n - 1):
                off = np.abs(way[i + 1 :] - way[i] - delta)
                if off.min() <= 0.1 * delta:
                    pairs.append((i, i + 1 + int(np.argmin(off))))
            return pairs
    else:
        if all_pairs:
            rotations = np.array([p[:3, :3] for p in model])
            angles = [angle_deg(rotations[i].T @ rotations[i + 1 :]) for i in range(n - 1)]
            return [
                (i, i + 1 + int(k))
                for i in range(n - 1)
                for k in np.flatnonzero(np.abs(angles[i] - delta) <= 0.1 * delta)
            ]
        steps = [angle_deg(a[:3, :3].T @ b[:3, :3]) for a, b in zip(model, model[1:])]
    pairs, start, done = [], 0, 0.0
    for i, step in enumerate(steps):
        done += step
        if done >= delta:
            pairs.append((start, i + 1))
            start, done = i + 1, 0.0
    return pairs[1:] if unit == "m" else pairs  # by metres the first pair begins where the delta is reached first


def relative_errors_evo(truth, model, unit, delta, all_pairs):
    return [
        inverse(inverse(truth[i]) @ truth[j]) @ inverse(model[i]) @ model[j]
        for i, j in pairs_evo(model, unit, delta, all_pairs)
    ]


def evaluate(*arguments):
    done = subprocess.run([PROGRAM, "evaluate", *map(str, arguments), "--json"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


class Reference(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        cls.cases = {"made": cls.make()}
        shared = SHARED / "evaluator"
        if shared.exists():
            cls.cases["freiburg1_xyz"] = (
                shared / "freiburg1_xyz-groundtruth.txt",
                shared / "freiburg1_xyz-rgbdslam.txt",
            )

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def make(cls):
        """Motion capture at 100 Hz; an estimate at 30 Hz in another world, at another scale, with drift and noise."""
        random = np.random.default_rng(7)

        def true_pose(t):
            turn, nod = 0.5 * math.sin(0.9 * t), 0.2 * math.sin(1.7 * t)
            return pose(
                rotation_about([0.2, 1, 0.1], turn) @ rotation_about([1, 0, 0], nod),
                [1.2 * math.sin(0.5 * t), 0.4 * math.sin(1.1 * t), 0.8 * math.cos(0.5 * t)],
            )

        def write(name, stamps, poses):
            lines = [
                f"{s:.6f} " + " ".join(f"{v:.9f}" for v in [*p[:3, 3], *quaternion(p[:3, :3])])
                for s, p in zip(stamps, poses)
            ]
            (cls.folder / name).write_text("# timestamp tx ty tz qx qy qz qw\n" + "\n".join(lines) + "\n")
            return cls.folder / name

        start = 1305031098.6659
        truth_stamps = np.round(start + np.arange(0, 12, 0.01), 6)
        stamps = np.round(start + 0.5 + np.arange(0, 11, 1 / 30) + random.uniform(-0.003, 0.003, 330), 6)
        away = pose(rotation_about([1, 2, 3], 0.8), [3, -2, 1])
        estimate = []
        for stamp in stamps:
            t = stamp - start
            noise = pose(rotation_about(random.normal(size=3), random.normal(0, 0.004)), random.normal(0, 0.003, 3))
            noisy = true_pose(t) @ noise
            noisy[:3, 3] += 0.002 * t
            estimate.append(away @ noisy)
        return (
            write("truth.txt", truth_stamps, [true_pose(s - start) for s in truth_stamps]),
            write("estimate.txt", stamps, scaled(estimate, 0.8)),
        )

    def same(self, found, errors, what):
        expected = statistics(errors)
        self.assertEqual(found["pairs"], expected["pairs"], what)
        for name in ("rmse", "mean", "median", "std", "min", "max"):
            self.assertLess(abs(found[name] - expected[name]), 1e-6 * abs(expected["rmse"]), f"{what} {name}")

    def matched(self, truth, model, match, limit):
        (truth_stamps, true_poses), (stamps, poses) = truth, model
        pairs = (associate_tum if match == "tum" else associate_evo)(truth_stamps, stamps, limit)
        return [true_poses[i] for i, _ in pairs], [poses[j] for _, j in pairs]

    def test_absolute_error(self):
        for case, files in self.cases.items():
            truth, model = map(read_tum, files)
            for match, limit in (("tum", 0.02), ("evo", 0.01), ("evo", 0.003)):
                for align in ("rigid", "origin", "none"):
                    for with_scale in (False, True):
                        with self.subTest(case=case, match=match, limit=limit, align=align, scale=with_scale):
                            found = evaluate(
                                *files,
                                "--match",
                                match,
                                "--max-difference",
                                limit,
                                "--align",
                                align,
                                *(["--scale"] if with_scale else []),
                            )["ate"]
                            matched = self.matched(truth, model, match, limit)
                            scale, distances, angles = absolute_errors(*matched, align, with_scale)
                            self.same(found["translation_m"], distances, "translation")
                            self.same(found["rotation_deg"], angles, "rotation")
                            self.assertAlmostEqual(found["scale"], scale, places=9)

    def test_relative_error_by_time(self):
        for case, files in self.cases.items():
            (truth_stamps, truth), (stamps, model) = map(read_tum, files)
            for delta in (1, 0.4):
                with self.subTest(case=case, delta=delta):
                    found = evaluate(*files, "--delta", delta)["rpe"]
                    per = "_per_s" if delta == 1 else ""
                    errors = relative_errors_tum(truth_stamps, truth, stamps, model, delta)
                    self.same(found["translation_m" + per], [np.linalg.norm(e[:3, 3]) for e in errors], "translation")
                    self.same(found["rotation_deg" + per], [angle_deg(e[:3, :3]) for e in errors], "rotation")

    def test_relative_error_by_motion(self):
        for case, files in self.cases.items():
            truth, model = map(read_tum, files)
            for unit, delta in (("frames", 1), ("frames", 7), ("m", 0.25), ("m", 1), ("deg", 5), ("deg", 10)):
                for all_pairs in (False, True):
                    for with_scale in (False, True):
                        with self.subTest(case=case, unit=unit, delta=delta, all=all_pairs, scale=with_scale):
                            found = evaluate(
                                *files,
                                "--match",
                                "evo",
                                "--max-difference",
                                0.01,
                                "--delta",
                                delta,
                                "--delta-unit",
                                unit,
                                *(["--all-pairs"] if all_pairs else []),
                                *(["--scale"] if with_scale else []),
                            )["rpe"]
                            true_poses, poses = self.matched(truth, model, "evo", 0.01)
                            if with_scale:
                                poses = scaled(poses, umeyama(positions(poses), positions(true_poses), True)[0])
                            errors = relative_errors_evo(true_poses, poses, unit, delta, all_pairs)
                            self.same(found["translation_m"], [np.linalg.norm(e[:3, 3]) for e in errors], "translation")
                            self.same(found["rotation_deg"], [angle_deg(e[:3, :3]) for e in errors], "rotation")

    def test_time_offset(self):
        """A clock that is late is found, and what is given is applied."""
        truth, estimate = self.cases["made"]
        late = self.folder / "late.txt"
        rows = [line.split(" ", 1) for line in estimate.read_text().splitlines()[1:]]
        late.write_text("\n".join(f"{float(stamp) + 0.1375:.6f} {rest}" for stamp, rest in rows) + "\n")
        expected = evaluate(truth, estimate, "--scale")["ate"]["translation_m"]["rmse"]
        given = evaluate(truth, late, "--scale", "--time-offset", "-0.1375")
        self.assertAlmostEqual(given["ate"]["translation_m"]["rmse"], expected, places=9)
        found = evaluate(truth, late, "--scale", "--time-offset", "auto")
        best = best_time_offset(*read_tum(truth), *read_tum(late), -0.1375)  # not quite, because of the drift
        self.assertLess(abs(best + 0.1375), 0.005)
        self.assertAlmostEqual(found["time_offset_s"], best, delta=0.0003)
        self.assertLess(found["ate"]["translation_m"]["rmse"], 1.02 * expected)
        self.assertGreater(evaluate(truth, late, "--scale")["ate"]["translation_m"]["rmse"], 2 * expected)

    def test_formats(self):
        """The same poses give the same numbers in all formats."""
        truth, estimate = self.cases["made"]
        stamps, poses = read_tum(estimate)
        texts = [line.split(" ")[0] for line in estimate.read_text().splitlines()[1:]]
        nanoseconds = [text.replace(".", "") + "000" for text in texts]
        quaternions = [quaternion(p[:3, :3]) for p in poses]
        header = "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []"
        asl = [
            ",".join([ns, *(f"{v:.12f}" for v in [*p[:3, 3], q[3], *q[:3]])])
            for ns, p, q in zip(nanoseconds, poses, quaternions)
        ]
        tum_ns = [
            " ".join([ns, *(f"{v:.12f}" for v in [*p[:3, 3], *q])]) for ns, p, q in zip(nanoseconds, poses, quaternions)
        ]
        expected = evaluate(truth, estimate)
        for name, format_name, unit, text in (
            (
                "euroc.csv",
                "ASL / EuRoC",
                "ns",
                header + ",v,v,v,b,b,b,b,b,b\n" + "\n".join(line + ",0" * 9 for line in asl),
            ),
            ("asl.csv", "ASL / EuRoC", "ns", header + "\n" + "\n".join(asl)),
            ("bare.csv", "ASL / EuRoC", "ns", "\n".join(asl)),
            ("ns.txt", "TUM", "ns", "\n".join(tum_ns)),
        ):
            with self.subTest(name=name):
                (self.folder / name).write_text(text + "\n")
                found = evaluate(truth, self.folder / name)
                self.assertEqual((found["estimate"]["format"], found["estimate"]["time_unit"]), (format_name, unit))
                for group in ("ate", "rpe"):
                    for part in expected[group]:
                        if isinstance(expected[group][part], dict):
                            for key, value in expected[group][part].items():
                                self.assertAlmostEqual(found[group][part][key], value, delta=1e-6 * (1 + abs(value)))

    def test_kitti(self):
        """No stamps: poses of the same number belong together, and the motion is taken from frame to frame."""
        truth, estimate = self.cases["made"]
        true_poses, poses = self.matched(read_tum(truth), read_tum(estimate), "tum", 0.02)

        def write(name, all_poses, rows=3):
            lines = [" ".join(f"{v:.9e}" for v in p[:rows].ravel()) + "\n" for p in all_poses]
            (self.folder / name).write_text("".join(lines))
            return self.folder / name

        _, distances, _ = absolute_errors(true_poses, poses, "rigid", False)
        errors = relative_errors_evo(true_poses, poses, "frames", 1, False)
        for rows in (3, 4):
            found = evaluate(write("truth_k.txt", true_poses, rows), write("estimate_k.txt", poses, rows))
            self.same(found["ate"]["translation_m"], distances, "translation")
            self.same(found["rpe"]["translation_m"], [np.linalg.norm(e[:3, 3]) for e in errors], "relative")
            self.assertEqual(found["rpe"]["delta_unit"], "frames")
            self.assertIsNone(found["duration_s"])
        stamps, _ = read_tum(estimate)
        found = evaluate(truth, estimate)
        timed = evaluate(write("truth_as_estimate.txt", poses), estimate)
        self.assertEqual(timed["ate"]["translation_m"]["pairs"], len(stamps))
        self.assertLess(timed["ate"]["translation_m"]["max"], 1e-7)
        self.assertEqual(timed["duration_s"], found["duration_s"])
        shorter = write("shorter.txt", poses[:-1])
        for files in ((truth, shorter), (write("k.txt", poses), shorter)):
            done = subprocess.run([PROGRAM, "evaluate", *map(str, files)], capture_output=True, text=True)
            self.assertEqual(done.returncode, 1)
            self.assertIn("equally many poses", done.stderr)


if __name__ == "__main__":
    unittest.main()
