//! Arguments of the linker of macOS, whose native modules find Python's symbols when they are loaded.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
