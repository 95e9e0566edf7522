// Seeded faults: mistakes that a test build can make on purpose, to show that the tests catch them (make faults).
// GRADUS_FAULT(name) is true in a process of that build whose environment variable GRADUS_FAULT has the value `name`.
// In every other build it is the constant false. tests/faults/faults.toml describes each fault and names the tests that
// must catch it.
#pragma once

// clang-format off
#define GRADUS_FAULT_NAMES(X)                    \
  X(lambert_without_cosine)                      \
  X(lambert_density_halved)                      \
  X(samples_one_percent_darker)                  \
  X(one_sample_in_1000_is_nan)                   \
  X(finite_check_accepts_all)                    \
  X(library_leaks_memory)                        \
  X(render_thread_swallows_exception)            \
  X(c_api_swallows_exception)                    \
  X(last_row_of_pixel_blocks_lost)               \
  X(last_row_of_passes_lost)                     \
  X(srgb_decoded_twice)                          \
  X(flat_normals_flipped)                        \
  X(further_camera_rays_count_in_full)           \
  X(guided_paths_forget_their_density)           \
  X(edges_judge_by_own_samples)                  \
  X(random_stream_shared_by_pixels)              \
  X(cancel_missed_between_samples)               \
  X(cancel_missed_by_render)                     \
  X(half_buffer_a_read_for_b)                    \
  X(sum_of_halves_taken_for_difference)          \
  X(mean_regressed_as_difference)                \
  X(residual_noise_counts_as_bias)               \
  X(second_step_takes_image_for_noise)           \
  X(feature_half_buffer_a_added_twice)           \
  X(feature_half_buffer_b_divided_by_count_of_a) \
  X(sum_of_halves_read_for_difference)           \
  X(l2_error_computed_from_image)                \
  X(features_shifted_by_a_column)                \
  X(second_step_albedo_shifted)                  \
  X(window_features_shifted_by_a_row)            \
  X(features_read_one_pixel_early)               \
  X(filter_distances_shifted)                    \
  X(samples_of_another_frame)                    \
  X(displacements_dropped)                       \
  X(denoiser_reads_displaced_light)              \
  X(hidden_samples_kept)                         \
  X(light_test_off)                              \
  X(moved_halves_dropped)                        \
  X(network_reads_one_frame)                     \
  X(joined_light_follows_surfaces)               \
  X(crowded_chains_follow_surfaces)              \
  X(strayed_chains_kept)                         \
  X(lost_light_not_restored)                     \
  X(image_variance_times_4)                      \
  X(image_variance_over_4)                       \
  X(pixel_variance_times_4)                      \
  X(pixel_variance_over_4)                       \
  X(window_variance_times_4)                     \
  X(window_variance_over_4)                      \
  X(window_bias_times_4)                         \
  X(regressed_difference_variance_times_4)       \
  X(sampled_difference_variance_over_4)          \
  X(feature_variance_times_4)                    \
  X(feature_variance_over_4)                     \
  X(filter_variance_times_4)                     \
  X(filter_variance_over_4)                      \
  X(error_scale_not_squared)                     \
  X(error_omits_bias)                            \
  X(error_includes_negative_bias)                \
  X(error_noise_not_relative_to_light)           \
  X(error_omits_lost_light)                      \
  X(error_omits_second_step)                     \
  X(half_difference_not_halved)                  \
  X(second_step_dropped)                         \
  X(second_step_of_other_channels_dropped)       \
  X(alpha_stays_noisy)                           \
  X(alpha_ignores_differences)                   \
  X(alpha_keeps_outliers)                        \
  X(alpha_lacks_large_windows)                   \
  X(alpha_lacks_own_values)                      \
  X(remainder_not_subtracted)                    \
  X(components_ignore_differences)               \
  X(offset_rays_lose_time)                       \
  X(offset_rays_lose_lens)                       \
  X(spawned_rays_lose_time)                      \
  X(reconnection_rays_lose_time)                 \
  X(shadow_rays_lose_time)                       \
  X(sun_rays_lose_time)                          \
  X(shutter_curve_ignored)                       \
  X(frame_position_in_exposure_ignored)          \
  X(deformed_mesh_shaded_at_nearest_key)         \
  X(normals_ignore_deformation)                  \
  X(camera_does_not_move)                        \
  X(camera_does_not_zoom)                        \
  X(panorama_lens_faces_camera_axis)             \
  X(stereo_eyes_exchanged)                       \
  X(replayed_pixels_take_own_seed)               \
  X(replayed_blocks_take_own_seed)               \
  X(replay_takes_same_pixel)                     \
  X(replay_ignores_border_corner)                \
  X(disocclusion_takes_own_numbers_again)        \
  X(replay_takes_mean_count)                     \
  X(two_pixels_match_one)                        \
  X(farther_pixel_keeps_match)                   \
  X(match_need_not_lead_back)                    \
  X(changed_mesh_taken_for_same)                 \
  X(objects_matched_by_index)                    \
  X(correspondence_not_inverted)                 \
  X(inverse_ends_in_pixel_centres)               \
  X(shot_change_not_detected)                    \
  X(zoom_is_no_shot_change)                      \
  X(frames_with_and_without_alpha_share_windows) \
  X(windows_extend_over_skipped_frame)           \
  X(temporal_difference_sign_flipped)            \
  X(temporal_difference_takes_fresh_samples)     \
  X(temporal_difference_of_same_pixel)           \
  X(unchanged_frame_not_repeated)                \
  X(temporal_difference_loads_fresh_frame)       \
  X(windows_read_fresh_samples_alone)            \
  X(passes_read_fresh_samples_alone)             \
  X(fresh_and_replayed_share_equally)            \
  X(window_shares_do_not_sum_to_1)               \
  X(window_grid_begins_at_job)                   \
  X(last_window_replaces_others)                 \
  X(spooled_half_differences_are_values)         \
  X(stored_frame_of_other_settings_accepted)     \
  X(stored_frame_of_other_scene_accepted)        \
  X(stored_neighbour_of_other_job_accepted)      \
  X(stored_frame_with_few_samples_accepted)      \
  X(temporary_file_remains)                      \
  X(stored_frame_named_before_complete)          \
  X(change_is_zero)                              \
  X(light_pass_difference_not_distributed)       \
  X(light_pass_difference_distributed_equally)   \
  X(light_passes_below_zero)                     \
  X(light_without_colour_remains)                \
  X(light_passes_exceed_their_noise)             \
  X(squares_of_light_overflow)                   \
  X(light_passes_lack_exposure)                  \
  X(light_passes_keep_first_reconstruction)
// clang-format on

namespace gradus {

#define GRADUS_FAULT_ENUMERATOR(name) name,
enum class Fault { none, GRADUS_FAULT_NAMES(GRADUS_FAULT_ENUMERATOR) };
#undef GRADUS_FAULT_ENUMERATOR

#ifdef GRADUS_FAULTS
// The fault of this process. A process whose environment variable names an unknown fault ends with exit code 2.
extern const Fault kSeededFault;
#define GRADUS_FAULT(name) (::gradus::kSeededFault == ::gradus::Fault::name)
#else
// The operand of sizeof is not evaluated. It makes the compiler refuse unknown names.
#define GRADUS_FAULT(name) (sizeof(::gradus::Fault::name) == 0)
#endif

}  // namespace gradus
