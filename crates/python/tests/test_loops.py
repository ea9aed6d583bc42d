import numpy as np
import pytest
import stickslip


def record(amplitude, force, cycles=5, samples=400, delay=0.4):
    """An ellipse: force leads displacement by ``delay`` rad."""
    tau = np.linspace(0, 2 * np.pi * cycles, cycles * samples, endpoint=False)
    return amplitude * np.cos(tau), force * np.cos(tau + delay), tau / (2 * np.pi * 20)


def test_an_ellipse_is_its_first_harmonic():
    loop = stickslip.Loop.fit(*record(8e-6, 12.0))
    assert loop.displacement_amplitude == pytest.approx(8e-6, rel=1e-4)
    assert loop.force_amplitude == pytest.approx(12.0, rel=1e-4)
    assert loop.phase == pytest.approx(0.4, abs=1e-3)
    assert loop.period == pytest.approx(0.05, rel=1e-4)
    assert loop.dissipation == pytest.approx(np.pi * 8e-6 * 12.0 * np.sin(0.4), rel=1e-3)
    theta = np.linspace(0, 6, 7)
    series = np.exp(1j * np.outer(theta, np.arange(loop.harmonics.size))) @ loop.harmonics
    np.testing.assert_allclose(loop.force(theta), series.real, rtol=1e-12)


def test_a_loop_goes_into_a_scene():
    loop = stickslip.Loop.fit(*record(1.0, 0.2))
    scene = stickslip.Scene(
        {
            "model": {"dofs": ["x"], "mass": [[1.0]], "damping": [[0.1]], "stiffness": [[1.0]]},
            "excitation": [{"dof": "x", "harmonic": 1, "amplitude": 1.0}],
            "contacts": [
                {"name": "c", "between": ["x", "ground"], "law": {"type": "scaled_loop", "loop": loop.to_scene()}}
            ],
            "frequencies": [0.1],
        }
    )
    assert scene.sweep().converged.all()


def test_files_and_mistakes(tmp_path):
    w, f, _ = record(8e-6, 12.0)
    path = tmp_path / "loop.csv"
    np.savetxt(path, np.column_stack([1e6 * w, f]), delimiter=",", header="displacement [um],force [N]", comments="")
    assert stickslip.Loop.read(path).displacement_amplitude == pytest.approx(8e-6, rel=1e-4)
    with pytest.raises(stickslip.LoopError):
        stickslip.Loop.fit(w, -f)
    with pytest.raises(stickslip.LoopError, match="as many"):
        stickslip.Loop.fit(w, f[:-1])


def test_scaling_laws_of_loops_that_follow_them():
    # The paper's eqs (6) and (7): g = 0.98 + 0.21 ln(alpha + 0.01), psi = -pi/2 - span exp(-4 alpha).
    alphas = np.array([0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0])
    span = 1.4660765716752369
    loops = []
    for alpha in alphas:
        g = 0.98 + 0.21 * np.log(alpha + 0.01)
        phase = np.pi - (np.pi / 2 + span * np.exp(-4 * alpha))
        loops.append(stickslip.Loop.fit(*record(8e-6 * alpha, 12.0 * g, delay=phase)))
    found = stickslip.scale(loops, magnitude="first-harmonic")
    assert found.reference["index"] == 6
    # W* and F* are those of the largest loop, where g is 0.982.
    scale = 0.98 + 0.21 * np.log(1.01)
    assert found.magnitude["slope"]["value"] == pytest.approx(0.21 / scale, rel=1e-2)
    assert found.phase["decay"]["value"] == pytest.approx(4.0, rel=2e-2)
    assert set(found.to_scene()) == {"magnitude", "phase"}
