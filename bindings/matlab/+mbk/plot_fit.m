function handles = plot_fit(varargin)
% mbk.plot_fit  Measured and predicted force, and the residual.
%
%   HANDLES = mbk.plot_fit(...) has the inputs of mbk.measure. It measures one recording and plots the measured force,
%   the predicted force and the residual, as the report does: on held-out data if there are any. HANDLES are the axes.
%
%   Example
%     mbk.plot_fit('log.mat', 'mode', 'reference')
%
%   See also mbk.measure, mbk.plot
  folder = tempname();
  mkdir(folder);
  page = fullfile(folder, 'report.html');
  cleaner = onCleanup(@() remove(folder, page));
  result = mbk.internal.run('measure', varargin, {'report', page});
  if ~strcmp(strtok(result.schema, '/'), 'mbk.result')
    error('mbk:usage', 'plot_fit takes one recording; give one file or one set of signals');
  end
  handles = mbk.internal.draw_fit(data_of(page), mbk.internal.unit_of(result, 'force'));
end

function report = data_of(page)
% The data of a report page, which the page contains as JSON.
  text = fileread(page);
  head = '<script type="application/json" id="report-data">';
  first = strfind(text, head);
  if isempty(first)
    error('mbk:data', 'this build of mbk has no report page; build mbk with MBK_WEB=ON');
  end
  text = text(first(1) + numel(head):end);
  last = strfind(text, '</script>');
  report = jsondecode(text(1:last(1) - 1));
end

function remove(folder, page)
  if exist(page, 'file') == 2
    delete(page);
  end
  rmdir(folder);
end
