"""The renderer's truth against geometry worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import binary_dilation

from visint.errors import InputError
from visint_lab.rays.finish import Checker, Noise, Plain
from visint_lab.rays.rig import Rig
from visint_lab.rays.scene import Grain, Lamp, Scene, Thing, turned
from visint_lab.rays.shapes import Box, Cylinder, Ellipsoid, Hyperboloid, Paraboloid, Plane, Sphere, Torus
from visint_lab.render.rendering import paint, render
from visint_lab.scenes import names
from visint_lab.scenes import scene as named

SIZE = (96, 120)
RIG = Rig.parallel(SIZE, 180.0, 5.0)
FRONT = Lamp("distant", (0.0, 0.0, -1.0))


MATT = Plain()


def scene(shape, finish=MATT, position=(0.0, 0.0, 50.0), rotation=None, lamp=FRONT, rig=RIG):
    thing = Thing(shape, finish, position, rotation or turned())
    return Scene("test", (thing,), lamp, rig)


def rays(camera):
    u, v = np.meshgrid(np.arange(camera.width) - camera.cx, np.arange(camera.height) - camera.cy)
    return np.stack([u / camera.focal_length, v / camera.focal_length, np.ones_like(u)], axis=-1)


def test_sphere_has_the_depth_and_normals_of_the_quadratic_equation():
    """|t r − c|² = R² gives the depth t; the normal is (t r − c)/R."""
    pair = render(scene(Sphere(8.0)), samples=1)
    ray, centre = rays(pair.camera), np.array([5.0, 0.0, 50.0])  # seen from the left eye at x = −5
    a, b, c = (ray**2).sum(-1), ray @ centre, centre @ centre - 64.0
    disc = b * b - a * c
    with np.errstate(invalid="ignore"):
        depth = (b - np.sqrt(disc)) / a
    np.testing.assert_array_equal(pair.truth.foreground, disc > 0)
    np.testing.assert_allclose(pair.truth.depth, depth, rtol=1e-6, atol=1e-5)
    np.testing.assert_allclose(pair.truth.normals, (depth[..., None] * ray - centre) / 8.0, rtol=0, atol=1e-5)


def test_plane_has_one_normal_and_the_depth_of_its_equation():
    """A plane through c with normal n has depth (n·c)/(n·r)."""
    rotation = turned(0.3, -0.2, 0.1)
    pair = render(scene(Plane(), rotation=rotation), samples=1)
    normal = -np.asarray(rotation)[:, 2]
    depth = normal @ np.array([5.0, 0.0, 50.0]) / (rays(pair.camera) @ normal)
    np.testing.assert_allclose(pair.truth.depth, depth, rtol=1e-6, atol=1e-5)
    np.testing.assert_allclose(pair.truth.normals, np.broadcast_to(normal, (*SIZE, 3)), atol=1e-5)


def test_cylinder_has_the_depth_and_normals_of_the_quadratic_equation():
    """Upright cylinder: the same as the sphere with the y components left out."""
    pair = render(scene(Cylinder(6.0, 8.0), rotation=turned(np.pi / 2)), samples=1)
    ray, centre = rays(pair.camera), np.array([5.0, 0.0, 50.0])
    flat = np.array([1.0, 0.0, 1.0])
    a, b, c = (ray**2 * flat).sum(-1), ray @ (centre * flat), centre @ (centre * flat) - 36.0
    with np.errstate(invalid="ignore"):
        depth = (b - np.sqrt(b * b - a * c)) / a
    point = depth[..., None] * ray
    mantle = np.abs(point[..., 1]) < 7.0
    assert mantle.sum() > 1500
    np.testing.assert_allclose(pair.truth.depth[mantle], depth[mantle], atol=1e-5)
    np.testing.assert_allclose(pair.truth.normals[mantle], ((point - centre) * flat / 6.0)[mantle], atol=1e-5)


IMPLICIT = {
    "ellipsoid": (Ellipsoid(8, 6, 5), lambda x, y, z: x**2 / 64 + y**2 / 36 + z**2 / 25 - 1),
    "paraboloid": (Paraboloid(7, 6), lambda x, y, z: x**2 + y**2 - 49 * (z + 6) / 12),
    "hyperboloid": (Hyperboloid(4, 5, 7), lambda x, y, z: x**2 + y**2 - 16 * (1 + z**2 / 25)),
    "torus": (Torus(7, 3), lambda x, y, z: (np.hypot(x, y) - 7) ** 2 + z**2 - 9),
    "box": (Box(6, 5, 4), lambda x, y, z: np.maximum(np.maximum(abs(x) - 6, abs(y) - 5), abs(z) - 4)),
}


@pytest.mark.parametrize("name", IMPLICIT)
def test_every_point_lies_on_its_surface_and_its_normal_is_the_gradient(name):
    """The implicit equation holds at the depth to 1e-5, and its gradient there is along the normal."""
    shape, form = IMPLICIT[name]
    rotation = np.asarray(turned(1.2, -0.4, 0.3))
    pair = render(scene(shape, rotation=tuple(map(tuple, rotation))), samples=1)
    seen = pair.truth.foreground
    depth = pair.truth.depth[seen].astype(float)
    local = (depth[:, None] * rays(pair.camera)[seen] - np.array([5.0, 0.0, 50.0])) @ rotation
    step = 1e-5
    gradient = np.stack([(form(*(local + step * e).T) - form(*(local - step * e).T)) for e in np.eye(3)], -1)
    steepness = np.linalg.norm(gradient, axis=-1)
    distance = np.abs(form(*local.T)) / (steepness / (2 * step))
    mantle = distance < 1e-5  # caps satisfy another equation
    assert mantle.mean() > 0.7
    assert len(depth) > 800
    cosine = (gradient / steepness[:, None] @ rotation.T * pair.truth.normals[seen]).sum(-1)
    assert (cosine[mantle] > 1 - 1e-5).mean() > 0.995  # a numerical gradient fails on a box's very edges


def test_both_disparities_agree_through_the_visible_mask():
    """The right disparity at the matched place is the left one, wherever the point is seen by both."""
    pair = render(scene(Torus(7, 3), rotation=turned(0.6, 0.3)), samples=1)
    truth = pair.truth
    rows, columns = np.nonzero(truth.visible)
    match = columns - truth.disparity[rows, columns].astype(float)
    low = np.clip(np.floor(match).astype(int), 0, SIZE[1] - 2)
    there = [truth.disparity_right[rows, low + i] for i in (0, 1)]
    share = match - low
    other = there[0] * (1 - share) + there[1] * share
    smooth = np.abs(there[0] - there[1]) < 0.5  # not across a depth edge
    assert smooth.mean() > 0.9
    difference = np.abs(other - truth.disparity[rows, columns])[smooth]
    assert np.median(difference) < 2e-3
    assert np.quantile(difference, 0.99) < 0.1


def test_a_hidden_point_is_not_visible_in_both():
    """Before a wall, a ball hides from the right camera what lies behind its left side."""
    things = (Thing(Sphere(5.0), position=(0, 0, 40.0)), Thing(Plane(), position=(0, 0, 60.0)))
    truth = render(Scene("test", things, FRONT, RIG), samples=1).truth
    row = SIZE[0] // 2
    ball = np.nonzero(truth.depth[row] < 50)[0]
    jump = round(180 * 10 / 40 - 180 * 10 / 60)  # disparity of ball less that of wall
    hidden = np.nonzero(~truth.visible[row])[0]
    beside = hidden[(hidden < ball[0]) & (hidden > ball[0] - jump - 2)]
    assert abs(len(beside) - jump) <= 3
    border = hidden[hidden < 180 * 10 / 60]
    assert len(border) == 30  # columns that leave the right image


def warp_residual(pair, shift):
    """What the right image, moved by the truth plus ``shift`` px, differs from the left one, pixel by pixel."""
    truth, image = pair.truth, pair.right.astype(float)
    ray = rays(pair.camera)
    other = ray - np.array([pair.camera.baseline, 0, 0]) / truth.depth[..., None]  # from the right eye
    cosines = [-(truth.normals * r).sum(-1) / np.linalg.norm(r, axis=-1) for r in (ray, other)]
    facing = (cosines[0] > 0.4) & (cosines[1] > 0.4)  # a pixel at a limb sees too much at once
    rows, columns = np.nonzero(truth.visible & facing & ~binary_dilation(truth.edges > 0, iterations=3))
    place = columns - truth.disparity[rows, columns] - shift
    low = np.clip(np.floor(place).astype(int), 1, image.shape[1] - 3)
    s = place - low
    taps = [image[rows, low + i] for i in (-1, 0, 1, 2)]
    weights = [-s * (1 - s) ** 2 / 2, 1 - 2.5 * s**2 + 1.5 * s**3, s * (0.5 + 2 * s - 1.5 * s**2)]
    weights.append(-(s**2) * (1 - s) / 2)
    warped = sum(w * t for w, t in zip(weights, taps, strict=True))
    return np.clip(warped - pair.left[rows, columns], -0.1, 0.1)


def assert_best_at_no_shift(pair):
    """Least squares over all pixels puts the best shift at 0 ± 0.05 px, and ± 1 px are much worse."""
    slope = (warp_residual(pair, 0.25) - warp_residual(pair, -0.25)) / 0.5
    best = -(warp_residual(pair, 0.0) * slope).sum() / (slope**2).sum()
    before, here, after = (np.sqrt((warp_residual(pair, shift) ** 2).mean()) for shift in (-1.0, 0.0, 1.0))
    assert abs(best) < 0.05
    assert here < 0.5 * min(before, after)


FINE = Rig.parallel((192, 240), 360.0, 5.0)
TURNED = Rig.parallel((192, 240), 560.0, 9.0, 45.0).converging_on((0, 0, 0))


@pytest.mark.parametrize("rig", [FINE, TURNED])
def test_warping_by_the_truth_is_best_at_no_shift(rig):
    """A textured ball, before parallel and before strongly converging cameras."""
    position = (0.0, 0.0, 50.0) if rig is FINE else (0.0, 0.0, 0.0)
    assert_best_at_no_shift(render(scene(Sphere(9.0), Noise(size=3.0, octaves=2), position, rig=rig)))


@pytest.mark.parametrize("name", [n for n in names() if "+" not in n and "specular" not in n])
def test_warping_every_clean_lambertian_scene_is_best_at_no_shift(name):
    """Shading alone, marks left out, pins the truth of each object of the sets."""
    try:
        made = named(name, 192)
    except InputError:
        pytest.skip("its range data is not there")
    assert_best_at_no_shift(render(made))


@pytest.mark.parametrize("lamp", [Lamp("distant", (0.4, -0.5, -1.0)), Lamp("point", (10.0, -20.0, -30.0))])
def test_shading_is_albedo_times_cosine(lamp):
    """Lambertian brightness is albedo·max(n·l, 0), with l from the light as visint knows it."""
    pair = render(scene(Ellipsoid(9, 6, 7), Plain(0.7), lamp=lamp), samples=1)
    seen = pair.truth.foreground
    points = (pair.truth.depth[..., None] * rays(pair.camera)).astype(np.float32)
    cosine = (pair.truth.normals * pair.light.directions(points)).sum(-1)
    np.testing.assert_allclose(pair.left[seen], 0.7 * np.maximum(cosine[seen], 0), atol=1e-4)


def test_highlight_lies_where_the_light_is_mirrored():
    """With light and eye at one place a sphere is brightest where its normal points there, by 0.4."""
    lamp = Lamp("point", (-5.0, 0.0, 0.0))
    pair = render(scene(Sphere(8.0), Plain(0.5, gloss=0.4, shininess=30.0), lamp=lamp), samples=1)
    u = 180 * 5 / 50 + pair.camera.cx
    assert pair.left.max() == pytest.approx(0.9, abs=0.02)
    row, column = np.unravel_index(pair.left.argmax(), SIZE)
    assert abs(column - u) <= 1
    assert abs(row - pair.camera.cy) <= 1


def test_cast_shadow_is_dark_and_labelled():
    """A ball's shadow on a wall: not lit, ambient brightness only, its outline labelled as shadow."""
    things = (
        Thing(Sphere(4.0), Plain(0.8), (0, 0, 40.0)),
        Thing(Plane(), Plain(0.8), (0, 0, 50.0)),
    )
    lamp = Lamp("distant", (-1.0, 0.0, -1.0), ambient=0.1)
    pair = render(Scene("test", things, lamp, RIG), samples=1)
    dark = ~pair.truth.lit & (pair.truth.depth > 49)
    assert dark.sum() > 200
    np.testing.assert_allclose(pair.left[dark], 0.08, atol=1e-6)
    assert (pair.truth.edges[dark] == 6).sum() + (pair.truth.edges == 6).sum() > 20


def test_rectified_converging_cameras_see_what_the_turned_ones_see():
    """A turned camera's image, looked up through the homography, is the rectified camera's own image."""
    rig = Rig.parallel((64, 64), 160.0, 9.0, 90.0).converging_on((0.0, 0.0, 0.0))
    made = scene(Sphere(14.0), Noise(size=12.0, octaves=2), (0, 0, 0), rig=rig)
    straight = rig.rectified()
    direct = paint(made, straight.left, samples=1)
    homography = rig.homography("left")
    spots = np.array([[20.0, 20.0], [32.0, 40.0], [45.0, 25.0], [31.5, 31.5]])
    moved = np.c_[spots, np.ones(4)] @ np.linalg.inv(homography).T
    moved = moved[:, :2] / moved[:, 2:]
    from visint_lab.render.probing import Prober

    old = Prober(made, rig.left, rig.right)(moved[:, 0], moved[:, 1])
    new = Prober(made, straight.left, straight.right)(spots[:, 0], spots[:, 1])
    np.testing.assert_allclose(old.brightness, new.brightness, atol=1e-9)
    whole = spots == np.round(spots)
    at = whole.all(1)
    np.testing.assert_allclose(new.brightness[at], direct[spots[at, 1].astype(int), spots[at, 0].astype(int)])


def test_the_point_that_converging_cameras_look_at_has_no_disparity():
    """The middle of both rectified images is the fixated point: d = 0 there, doffs = fB/Z."""
    rig = Rig.parallel(SIZE, 300.0, 9.0, 90.0).converging_on((0.0, 0.0, 0.0))
    pair = render(scene(Plane(), position=(0, 0, 0), rig=rig), samples=1)
    assert pair.camera.doffs == pytest.approx(300 * 18 / 90)
    np.testing.assert_allclose(pair.truth.disparity, 0.0, atol=1e-4)
    np.testing.assert_allclose(pair.truth.depth, 90.0, atol=1e-4)


def test_noise_has_the_asked_spread_and_follows_its_seed():
    """Additive and multiplicative noise of mid-grey have the standard deviations asked for; seeds repeat."""
    grey = replace(scene(Plane(), Plain(0.5)), grain=Grain(additive=0.02))
    one, again, other = (render(grey, samples=1, seed=s).left for s in (1, 1, 2))
    np.testing.assert_array_equal(one, again)
    assert not np.array_equal(one, other)
    assert (one - 0.5).std() == pytest.approx(0.02, rel=0.05)
    factor = render(replace(grey, grain=Grain(multiplicative=0.1)), samples=1).left
    assert (factor - 0.5).std() == pytest.approx(0.05, rel=0.05)


@pytest.mark.parametrize("half_width", [2.75, 4.9])
def test_a_flat_face_seen_at_a_low_angle_has_no_limb(half_width):
    """The far edge of a long box's side is seen at a cosine of 0.03 or 0.001: it occludes, as any edge."""
    edges = render(scene(Box(half_width, 5.0, 20.0)), samples=1).truth.edges
    assert not (edges == 1).any()
    assert (edges == 2).sum() > 50


def test_checker_edges_are_marks_and_box_edges_are_creases():
    """A turned checkered box has convex creases inside its outline, marks on its faces, no limb."""
    pair = render(scene(Box(6, 6, 6), Checker(size=3.0), rotation=turned(0.6, 0.7)), samples=1)
    kinds = set(np.unique(pair.truth.edges))
    assert kinds == {0, 2, 3, 5}
    assert len(np.unique(pair.truth.regions)) == 4


def test_a_ball_has_a_limb_and_a_cylinder_has_both():
    """A ball's outline is a limb throughout; a cylinder's is limb along its sides and occluding at its caps."""
    ball = render(scene(Sphere(7.0)), samples=1).truth.edges
    assert set(np.unique(ball)) == {0, 1}
    can = render(scene(Cylinder(5.0, 7.0), rotation=turned(1.2)), samples=1).truth.edges
    counts = np.bincount(can.ravel(), minlength=7)
    assert (counts[1:4] > 20).all()
    assert counts[4:].sum() == 0


def test_a_box_on_a_floor_meets_it_in_a_concave_crease():
    """Where two surfaces touch and face each other the label is concave."""
    floor = Thing(Plane(), position=(0, 5.0, 50.0), rotation=turned(1.2))
    box = Thing(Box(5, 5, 5), position=(0, 0.0, 50.0), rotation=turned(0.35, 0.6))
    edges = render(Scene("test", (box, floor), FRONT, RIG), samples=1).truth.edges
    assert (edges == 4).sum() > 20
