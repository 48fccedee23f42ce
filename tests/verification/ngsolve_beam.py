"""The heavy cantilever of beams.h in NGSolve (Schoeberl, C++11 implementation of finite elements in NGSolve, 2014), an
independent program: cubes of one order, their inner unknowns condensed, its own sparse Cholesky, one thread.

    python3 ngsolve_beam.py N ORDER    N cubes over the height

Prints how far the free end's middle sinks [m], and CPU seconds of mesh, assembly and solution [s].
"""

import sys
import time

import ngsolve as ng
from ngsolve.meshes import MakeStructured3DMesh

n, order = int(sys.argv[1]), int(sys.argv[2])
youngs_modulus, nu, density, gravity = 1e6, 0.3, 1000, 9.81
mu, lame = youngs_modulus / (2 * (1 + nu)), youngs_modulus * nu / ((1 + nu) * (1 - 2 * nu))

ng.SetNumThreads(1)
start = time.process_time()
mesh = MakeStructured3DMesh(
    hexes=True, nx=5 * n, ny=n, nz=n, mapping=lambda x, y, z: (x, 0.2 * y - 0.1, 0.2 * z - 0.1)
)
space = ng.VectorH1(mesh, order=order, dirichlet="back")  # where x = 0
u, v = space.TnT()
strain = ng.Sym(ng.Grad(u))
stress = 2 * mu * strain + lame * ng.Trace(strain) * ng.Id(3)
stiffness = ng.BilinearForm(ng.InnerProduct(stress, ng.Grad(v)) * ng.dx, condense=True).Assemble()
load = ng.LinearForm(-density * gravity * v[2] * ng.dx).Assemble()
tip = ng.GridFunction(space)
load.vec.data += stiffness.harmonic_extension_trans * load.vec
tip.vec.data = stiffness.mat.Inverse(space.FreeDofs(True), inverse="sparsecholesky") * load.vec
tip.vec.data += stiffness.harmonic_extension * tip.vec + stiffness.inner_solve * load.vec
print(-tip(mesh(1, 0, 0))[2], time.process_time() - start)
