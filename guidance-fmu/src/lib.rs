pub mod scvx;
