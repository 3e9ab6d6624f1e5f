function handles = draw_fit(report, unit)
% Plots force, prediction and residual from the data of a report.
  trials = mbk.internal.items(report.trials);
  found = trials{1}.diagnostics.prediction;
  time = found.time_s(:)';
  measured = as_rows(found.measured, numel(time));
  predicted = as_rows(found.predicted, numel(time));
  residual = as_rows(found.residual, numel(time));
  count = size(measured, 1);
  names = {''};
  if count == 2
    names = {' x', ' y'};
  end
  handles = zeros(1, 0);
  for k = 1:count
    handles(end + 1) = subplot(2 * count, 1, 2 * k - 1);
    plot(time, measured(k, :), 'Color', mbk.internal.style('other'), 'LineWidth', 1.5);
    hold on
    plot(time, predicted(k, :), 'Color', mbk.internal.style('second'));
    hold off
    grid on
    xlim(time([1 end]));
    mbk.internal.label('', mbk.internal.with_unit(['force' names{k}], unit));
    if k == 1
      names_of_data = {'the data to which the model was fitted', 'held-out data'};
      title(['force (grey) and prediction (orange), ' names_of_data{1 + found.held_out}]);
    end
    handles(end + 1) = subplot(2 * count, 1, 2 * k);
    plot(time, residual(k, :), 'Color', mbk.internal.style('first'));
    grid on
    xlim(time([1 end]));
    mbk.internal.label('', mbk.internal.with_unit(['residual' names{k}], unit));
  end
  mbk.internal.label('time (s)', mbk.internal.with_unit(['residual' names{count}], unit));
end

function values = as_rows(values, count)
% A row for each axis; one axis may have been decoded as a column.
  if size(values, 2) ~= count
    values = values';
  end
end
