//! Every target: its files are translated and run by the tools of the target, and give the outputs of the library.

mod abaqus;
mod c;
mod case;
mod closed_loop;
mod elementary;
mod fmu;
mod foreign;
mod fused;
mod invalid;
mod inverse;
mod inverse_case;
mod inverse_fmu;
mod matlab;
mod names;
mod onnx;
mod opensees;
mod python;
mod states;
mod tools;
mod tracking;
