"""The mathematics of the rocking can, dimensionless: the truth with which engines are compared.

`solve` solves a `Problem`. The paper's closed formulas are functions too; the docstring of each, or
of its module, says where the paper is in error.

    steady_rotation                  eq01:equilibrium
    squared_eigenvalue               eq01:eigenvalues
    critical_rolling_rate            where eq01:eigenvalues vanish
    balanced_rotation                eq01:bal_eqm
    circle_radius, rest_rates        below eq01:comcoords and eq01:comrest
    paper_constants                  B_0 and B_{-2} of eq01:psi_orig
    leading_constants                eq01:A_sol, eq01:B_sol
    hypergeometric_pair              eq01:hyper_geom
    matched_of                       eq01:outer_solution to eq01:angle_of_turn
    boundary_rotation                eq01:boundary
    locus_arc                        eq01:contact_pt_inner, eq01:contact_pt_outer
    friction_bound, friction_ratio   eq01:required_friction, eq01:friction_short
    locus_velocity                   eq01:contact_point_velocity
    centre_velocity                  eq01:com_velocity; centre_position is its integral
    leading_turn_without_friction    app01:Phi_reduced_slip
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
