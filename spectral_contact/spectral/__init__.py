"""The discretised operators of axisymmetric contact: a public subpackage, usable on its own.

It knows panels, half-order integrals and the two kernels; it knows no scene, friction or Poisson's
ratio.
"""

__all__: list[str] = []
