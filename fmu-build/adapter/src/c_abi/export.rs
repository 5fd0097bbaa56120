//! Macros that make C symbols. Only for leaf cdylibs and tests.

/// Exports one [`Component`](lander_models::Component) under the symbols of FMI 2.0 and 3.0.
#[macro_export]
macro_rules! export {
    ($component:ty) => {
        $crate::export_fmi2!($component);
        $crate::export_fmi3!($component);
    };
}

/// `symbol(arguments of the header after the instance) = module::function(those it needs)`.
#[doc(hidden)]
#[macro_export]
macro_rules! fmi_functions {
    ($component:ty: $($symbol:ident($($argument:ident: $type:ty),*)
        = $module:ident::$function:ident($($passed:expr),*);)*) => {$(
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $symbol(
            instance: $crate::c_abi::Handle, $($argument: $type),*
        ) -> $crate::c_abi::Status {
            unsafe {
                $crate::$module::$function::<$component>(
                    instance, stringify!($symbol), $($passed),*
                )
            }
        }
    )*};
}

/// Functions that no declared capability allows.
#[doc(hidden)]
#[macro_export]
macro_rules! fmi_unsupported {
    ($component:ty: $($symbol:ident($($type:ty),*);)*) => {$(
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $symbol(
            instance: $crate::c_abi::Handle, $(_: $type),*
        ) -> $crate::c_abi::Status {
            unsafe { $crate::c_abi::unsupported::<$component>(instance, stringify!($symbol)) }
        }
    )*};
}
