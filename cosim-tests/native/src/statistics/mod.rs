//! What a sample says about the distribution it is from, and how surely.

pub mod beta;
pub mod binomial;
pub mod normal;
pub mod paired;
pub mod quantile;
pub mod rank_correlation;
pub mod sobol;
pub mod spread;
pub mod subset;
