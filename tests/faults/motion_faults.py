"""Faults in motion blur, cameras and motion vectors."""

from __future__ import annotations

from fault import Fault, Test, native, statistics

CAMERA = "native/src/camera/camera.cpp"
EMITTERS = "native/src/light/light_sampling.cpp"
MESH = "native/src/geometry/mesh.cpp"
OFFSET_RAYS = "native/src/gradient/offset_rays.cpp"
SEGMENT = "native/src/path/segment.cpp"
SHUTTER = "native/src/camera/shutter.cpp"
STEREO = "native/src/camera/spherical_stereo.cpp"
EXPORTED_MOTION = "addon/gradus/export/motion.py"
EXPORTED_SHUTTER = "addon/gradus/export/shutter.py"
EXPORTER = "addon/gradus/export/exporter.py"

MOVED = "base.camera_sample.moved(Vec2(film::kOffsetX[k], film::kOffsetY[k]))"
MOVED_FILM = "base.camera_sample.film + Vec2(film::kOffsetX[k], film::kOffsetY[k])"


def blur(choice: str) -> Test:
    return Test("tests/addon/motion_blur_test.py", choice)


OF_MOTION = (native("Motion.*"),)
OF_SHADOWS = (native("MovingShadow.LightIsLookedForAtTheMomentOfThePath"),)
OF_VECTORS = (blur("vectors_and_blur"),)

MOMENT = "shutter time lost"
SHUTTER_SETTINGS = "shutter ignored"
KEYS = "motion keys mixed up"
CAMERAS = "wrong camera"
VECTORS = "motion vectors of another time"

MOTION = (
    Fault(
        18,
        MOMENT,
        "offset paths are traced at the opening of the shutter",
        OFFSET_RAYS,
        MOVED,
        f"{{{MOVED_FILM}, base.camera_sample.lens}}",
        (statistics("*/Scenarios.B7_GradientsAreDifferencesOfTheImage/Moving"),),
    ),
    Fault(
        18,
        MOMENT,
        "offset paths go through the centre of the lens",
        OFFSET_RAYS,
        MOVED,
        f"{{{MOVED_FILM}, Vec2(0.0f), base.camera_sample.time}}",
        (statistics("B7_Lens.DifferencesAreThoseOfTheBlurredImage"),),
    ),
    Fault(
        18,
        MOMENT,
        "rays that leave a surface lose their time",
        SEGMENT,
        "direction, distance, from.hit.time}",
        "direction, distance, 0.0f}",
        (native("Motion.RaysThatLeaveDoNotMeetTheirSurfaceAgain"),),
    ),
    Fault(
        18,
        MOMENT,
        "offset paths reconnect at the opening of the shutter",
        SEGMENT,
        "direction, from.hit.time);",
        "direction, 0.0f);",
        (native("Motion.RaysFromASurfaceAreAtItsTime"),),
    ),
    Fault(
        18,
        MOMENT,
        "shadow rays to analytic and mesh lights are traced at the opening of the shutter",
        EMITTERS,
        "return geometry::ray_between(start, target, view.direction, from.hit.time);",
        "return geometry::ray_between(start, target, view.direction, 0.0f);",
        OF_SHADOWS,
    ),
    Fault(
        18,
        MOMENT,
        "shadow rays to the sun are traced at the opening of the shutter",
        EMITTERS,
        "return Ray{start, 0.0f, view.direction, kInfinity, from.hit.time};",
        "return Ray{start, 0.0f, view.direction, kInfinity, 0.0f};",
        OF_SHADOWS,
    ),
    Fault(
        19,
        SHUTTER_SETTINGS,
        "the shutter curve is ignored",
        SHUTTER,
        "if (cumulative_.empty()) return u;",
        "if (cumulative_.empty() || u >= 0.0f) return u;",
        (native("Shutter.MomentsAreDistributedAsTheCurveIs"),),
    ),
    Fault(
        19,
        SHUTTER_SETTINGS,
        "the position of the frame within the exposure is ignored",
        SHUTTER,
        "std::clamp(-open_ / (close_ - open_), 0.0f, 1.0f)",
        "0.5f",
        (native("Shutter.KnowsWhenTheFrameIs"),),
    ),
    Fault(
        19,
        SHUTTER_SETTINGS,
        "the exposure ends where it should begin",
        EXPORTED_SHUTTER,
        '{"START": 0.0, "END": -length}',
        '{"START": -length, "END": 0.0}',
        (blur("exposure"),),
    ),
    Fault(
        19,
        SHUTTER_SETTINGS,
        "the motion steps of an object are ignored",
        EXPORTED_SHUTTER,
        "Blur(min(2**steps + 1, MAX_KEYS), deform)",
        "Blur(3, deform)",
        (blur("steps_and_switches"),),
    ),
    Fault(
        20,
        KEYS,
        "a mesh deforms backwards",
        EXPORTED_MOTION,
        "return None if found is None else _joined(found)",
        "return None if found is None else _joined(found[::-1])",
        (blur("deforming_mesh_has"),),
    ),
    Fault(
        20,
        KEYS,
        "velocities are taken as metres per frame",
        EXPORTED_MOTION,
        "[time / frames_per_second for time in (shutter.open, shutter.close)]",
        "[time for time in (shutter.open, shutter.close)]",
        (blur("velocities_blur"),),
    ),
    Fault(
        20,
        KEYS,
        "a deformed mesh is shaded at its nearest key",
        MESH,
        "p[k] = a[v] * (1.0f - place.share) + b[v] * place.share;",
        "p[k] = place.share < 0.5f ? a[v] : b[v];",
        (native("Motion.HitsLieOnTheRayAtItsTime"),),
    ),
    Fault(
        20,
        KEYS,
        "normals do not turn with a deformation",
        MESH,
        "k < 3 && mesh.shutter_keys > 0; ++k",
        "k < 3 && mesh.shutter_keys > 99; ++k",
        (native("Motion.NormalsTurnWithADeformation"),),
    ),
    Fault(
        21,
        CAMERAS,
        "the camera does not move while the shutter is open",
        CAMERA,
        "const Mat4 m = keys_.at(time);",
        "const Mat4 m = keys_.at(0.0f * time);",
        (native("Camera.MovesAndZoomsWhileTheShutterIsOpen"),),
    ),
    Fault(
        21,
        CAMERAS,
        "the camera does not zoom while the shutter is open",
        CAMERA,
        "a[i] * (1.0f - place.share) + b[i] * place.share;",
        "a[i] + 0.0f * b[i];",
        (native("Camera.MovesAndZoomsWhileTheShutterIsOpen"),),
    ),
    Fault(
        21,
        CAMERAS,
        "the lens of a panorama is perpendicular to the axis of the camera, not to each direction",
        CAMERA,
        "panorama_lens_axes(desc_, direction, &u, &v);",
        "panorama_lens_axes(desc_, Vec3(0, 0, -1), &u, &v);",
        (native("*Panorama.RaysOfAFilmPointMeetAtTheDistanceOfFocus*"),),
    ),
    Fault(
        21,
        CAMERAS,
        "the left and the right eye are exchanged",
        STEREO,
        "const Vec3 side = glm::cross(*direction, up);",
        "const Vec3 side = glm::cross(up, *direction);",
        (native("SphericalStereo.RaysLeaveTheEyesCircle"),),
    ),
    Fault(
        22,
        VECTORS,
        "instances: the times of motion blur are taken for those of the neighbouring frames",
        EXPORTER,
        "around = (moments[time] for time in motion.NEIGHBORS)",
        "around = (moments[time] for time in sorted(moments)[:2])",
        OF_VECTORS,
    ),
    Fault(
        22,
        VECTORS,
        "the camera: the times of motion blur are taken for those of the neighbouring frames",
        EXPORTER,
        "around = [motion.camera_at(view, moments[time]) for time in motion.NEIGHBORS]",
        "around = [motion.camera_at(view, moments[time]) for time in sorted(moments)[:2]]",
        OF_VECTORS,
    ),
    Fault(
        22,
        VECTORS,
        "meshes: the times of motion blur are taken for those of the neighbouring frames",
        EXPORTED_MOTION,
        "found = [moments[time].positions.get(deforming.shape) for time in NEIGHBORS]",
        "found = [moments[time].positions.get(deforming.shape) for time in sorted(moments)[:2]]",
        OF_VECTORS,
    ),
)
