"""Single images and surfaces, read in visint's own frame."""

import numpy as np
import pytest

import visint
from visint_lab.datasets import data_folder
from visint_lab.datasets.singles import read_single, single_names


def have():
    try:
        return bool(data_folder("extra"))
    except visint.InputError:
        return False


needs_data = pytest.mark.skipif(not have(), reason="the extra data is not there")


@needs_data
@pytest.mark.parametrize("name", single_names())
def test_everything_reads_and_fits_together(name):
    """Images and maps have the mask's size; normals are unit and face the camera."""
    found = read_single(name)
    assert found.mask.any()
    assert all(image.shape == found.mask.shape and image.dtype == np.float32 for image in found.images)
    assert len(found.lights) in (0, len(found.images))
    if found.normals is not None:
        known = found.normals[np.isfinite(found.normals[..., 0])]
        np.testing.assert_allclose(np.linalg.norm(known, axis=-1), 1, atol=1e-3)
        assert np.mean(known[:, 2] < 0) > 0.97


@needs_data
def test_the_bunny_is_lambertian_under_its_light():
    """Brightness follows n·l, with normals and light both turned into our frame."""
    found = read_single("shading/bunny")
    cosine = np.maximum(found.normals[found.mask] @ np.array(found.lights[0].vector), 0)
    assert np.corrcoef(cosine, found.images[0][found.mask])[0, 1] > 0.99


@needs_data
def test_a_statue_looks_up_at_its_top():
    """Normals near the upper outline point up, that is to −y, and to the left at the left."""
    found = read_single("gradients/bear")
    rows, columns = np.nonzero(found.mask)
    top, left = (
        found.normals[found.mask][part] for part in (rows < rows.min() + 8, columns < columns.min() + 8)
    )
    assert np.nanmean(top[:, 1]) < -0.3
    assert np.nanmean(left[:, 0]) < -0.3


def test_an_unknown_name_lists_the_known():
    """The error names what there is."""
    with pytest.raises(visint.UsageError, match="texture/brick"):
        read_single("texture/tweed")
