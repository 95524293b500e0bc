//! Smoothed particle hydrodynamics conduction (Cleary and Monaghan): the weight of a pair.
