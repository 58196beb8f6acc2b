// SPDX-License-Identifier: MIT
//! vkao from Rust, on a device that ash has made: a context and an effect of the exported defaults.
//! Exit status 77 where there is no device.

use ash::vk;
use std::ffi::{c_char, c_void, CStr};
use std::ptr::{null, null_mut};

/// vkao_context_info
#[repr(C)]
struct ContextInfo {
    struct_size: u32,
    log_level: u32,
    instance: vk::Instance,
    physical_device: vk::PhysicalDevice,
    device: vk::Device,
    get_instance_proc_addr: Option<vk::PFN_vkGetInstanceProcAddr>,
    get_device_proc_addr: Option<vk::PFN_vkGetDeviceProcAddr>,
    enabled_features: *const vk::PhysicalDeviceFeatures2,
    allocator: *const vk::AllocationCallbacks,
    log: Option<unsafe extern "C" fn(*mut c_void, u32, *const c_char)>,
    log_user_data: *mut c_void,
    mark: *const c_void,
    mark_user_data: *mut c_void,
    debug_labels: vk::Bool32,
    padding: u32,
}

/// vkao_effect_info: nothing of it is changed here, so that its size is enough
#[repr(C)]
struct EffectInfo([u64; 15]);

#[link(name = "vkao")]
extern "C" {
    fn vkao_context_info_init(out: *mut ContextInfo, size: u32);
    fn vkao_effect_info_init(out: *mut EffectInfo, size: u32);
    fn vkao_add_required_features(features: *mut vk::PhysicalDeviceFeatures);
    fn vkao_context_create(info: *const ContextInfo, out: *mut *mut c_void) -> i32;
    fn vkao_context_destroy(context: *mut c_void);
    fn vkao_effect_create(
        context: *const c_void,
        info: *const EffectInfo,
        out: *mut *mut c_void,
    ) -> i32;
    fn vkao_effect_destroy(effect: *mut c_void);
}

unsafe extern "C" fn print_log(_: *mut c_void, _: u32, message: *const c_char) {
    eprintln!("vkao: {}", CStr::from_ptr(message).to_string_lossy());
}

unsafe fn run(entry: &ash::Entry) -> Result<(), vk::Result> {
    let application = vk::ApplicationInfo::builder().api_version(vk::API_VERSION_1_1);
    let instance = entry.create_instance(
        &vk::InstanceCreateInfo::builder().application_info(&application),
        None,
    )?;
    let physical_device = *instance
        .enumerate_physical_devices()?
        .first()
        .ok_or(vk::Result::ERROR_INITIALIZATION_FAILED)?;
    let mut features = vk::PhysicalDeviceFeatures2::default();
    vkao_add_required_features(&mut features.features);
    let queues = [vk::DeviceQueueCreateInfo::builder().queue_priorities(&[1.0]).build()];
    let device = instance.create_device(
        physical_device,
        &vk::DeviceCreateInfo::builder().queue_create_infos(&queues).push_next(&mut features),
        None,
    )?;

    let mut info: ContextInfo = std::mem::zeroed();
    vkao_context_info_init(&mut info, std::mem::size_of::<ContextInfo>() as u32);
    assert_eq!(info.struct_size as usize, std::mem::size_of::<ContextInfo>());
    info.instance = instance.handle();
    info.physical_device = physical_device;
    info.device = device.handle();
    info.get_instance_proc_addr = Some(entry.static_fn().get_instance_proc_addr);
    info.get_device_proc_addr = Some(instance.fp_v1_0().get_device_proc_addr);
    info.enabled_features = &features;
    info.log = Some(print_log);
    let mut context = null_mut();
    assert_eq!(vkao_context_create(&info, &mut context), 0);

    let mut settings: EffectInfo = std::mem::zeroed();
    vkao_effect_info_init(&mut settings, std::mem::size_of::<EffectInfo>() as u32);
    assert_eq!(settings.0[0] as u32 as usize, std::mem::size_of::<EffectInfo>());
    let mut effect = null_mut();
    assert_eq!(vkao_effect_create(context, &settings, &mut effect), 0);
    assert_ne!(effect as *const c_void, null());
    vkao_effect_destroy(effect);
    vkao_context_destroy(context);
    device.destroy_device(None);
    instance.destroy_instance(None);
    Ok(())
}

fn main() {
    if let Err(error) = unsafe { run(&ash::Entry::linked()) } {
        eprintln!("{error}");
        std::process::exit(77);
    }
}
