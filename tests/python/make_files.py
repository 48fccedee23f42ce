"""Makes what the other tests read: small runs and studies, by the program itself."""

import shutil

from support import FILES, SOURCES, kerf

STABILITY = """
subsection Stability
  set Title     = A block
  set Scene     = {scene}
  set Steps [1] = 5
end
subsection Variant fem
  set Set = Body block/Element=trilinear
end
subsection Variant fem-symplectic
  set Set = Body block/Integrator=symplectic Euler | Time/Time step [s]=0.0002
end
subsection Change stiffness
  subsection Case soft
    set Set = Body block/Material/Young's modulus [Pa]=1e3
  end
  subsection Case stiff
    set Set = Body block/Material/Young's modulus [Pa]=1e12
  end
end
subsection Change start
  subsection Case stretched
    set Set = Body block/Initial state/Displacement [m]=0.2*x; 0.2*y; 0.2*z
  end
  subsection Case rest
  end
end
subsection Sweep stiff
  set Changes = stiffness, start
end
"""

NO_REFERENCE = """
subsection Study
  set Title  = Energy of a bar
  set Scene  = {scene}
  set Answer = elastic energy
  set Unit   = J
end
subsection Variant fem
end
subsection Variant soft
  set Set = Body bar/Material/Young's modulus [Pa]=1e5
end
subsection Change end
  subsection Case one
    set Set = Time/End time [s]=0.02
  end
end
"""


def make(*arguments, seconds=None, exit_code=0):
    """Runs the program, for no longer than some seconds."""
    done = kerf(*arguments, seconds=seconds)
    if done.returncode != exit_code:
        raise SystemExit(f"kerf {' '.join(map(str, arguments))} has ended with {done.returncode}: {done.stderr}")


def run(name, *sets):
    """params/first.prm on a coarse grid, cut through, with stress and few images."""
    changes = [
        "Body bar/Cube edge [m]=0.07",
        "Output/Frames every [1]=10",
        "Output/Fields=von Mises stress, displacement",
    ]
    words = [word for one in [*changes, "Images/Every [1]=100", *sets] for word in ("--set", one)]
    make("run", SOURCES / "params/first.prm", *words, "--output", FILES / name, "--threads", "1")


def main():
    shutil.rmtree(FILES, ignore_errors=True)
    FILES.mkdir(parents=True)
    run("bar")
    run("springs", "Body bar/Backend=mass-spring", "Output/Fields=none")
    run("short", "Time/End time [s]=0.2")
    # three rows of it fail by intent
    make("study", SOURCES / "params/studies/quick.prm", "--output", FILES / "quick", "--threads", "1", seconds=120, exit_code=3)
    (FILES / "energy.prm").write_text(NO_REFERENCE.format(scene=SOURCES / "params/first.prm"))
    make("study", FILES / "energy.prm", "--output", FILES / "energy", "--threads", "1")
    (FILES / "block.prm").write_text(STABILITY.format(scene=SOURCES / "params/stability/block.prm"))
    make("study", FILES / "block.prm", "--output", FILES / "block", "--threads", "1")
    words = ["--largest", "216", "--samples", "1", "--only", "energy"]
    make("bench", *words, "--output", FILES / "bench")
    make("table", "--output", FILES / "table.h5")


if __name__ == "__main__":
    main()
