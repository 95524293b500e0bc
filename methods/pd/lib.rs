//! Bond-based peridynamic heat conduction: the weight of a bond.
